"""Files of tenants: part tables in versions that are never overwritten, and uploads for batches."""

from __future__ import annotations

import gzip
import re
from collections.abc import Iterable, Mapping

import sqlalchemy as sa
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from synth.errors import InputError
from synth.queue.job_queue import JobQueue
from synth.queue.job_table import new_id
from synth.queue.models import Catalogue, Job, Upload, moment
from synth.queue.records import Record, Sources, mentioned
from synth.tables.table_text import TableText

NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,59}")
REFERENCE = re.compile(r"([A-Za-z0-9_][A-Za-z0-9_.-]{0,59})@([1-9][0-9]{0,8})")
DEPTH = 3  # jobs that refer to jobs: a report of prices of a front


class TenantFiles:
    """The tables and files of tenants, in the database of their jobs.

    Parameters
    ----------
    queue : JobQueue
    """

    def __init__(self, queue: JobQueue) -> None:
        self._queue = queue
        self._engine = queue.engine

    # -- part tables ---------------------------------------------------------------------------

    def catalogues(self, tenant: int) -> list[Catalogue]:
        """Return all versions of all tables of a tenant, by name, the latest version first; without their content."""
        light = sa.orm.defer(Catalogue.content), sa.orm.defer(Catalogue.schema)
        query = sa.select(Catalogue).where(Catalogue.tenant == tenant).options(*light)
        with Session(self._engine, expire_on_commit=False) as session:
            return list(session.scalars(query.order_by(Catalogue.name, Catalogue.version.desc())))

    def catalogue(self, tenant: int, name: str, version: int | None = None) -> Catalogue | None:
        """Return one version of a table, the latest where none is named; None where there is none."""
        query = sa.select(Catalogue).where(Catalogue.tenant == tenant, Catalogue.name == name)
        if version is not None:
            query = query.where(Catalogue.version == version)
        with Session(self._engine, expire_on_commit=False) as session:
            return session.scalar(query.order_by(Catalogue.version.desc()).limit(1))

    def table_text(self, tenant: int, reference: str) -> TableText | None:
        """Return the text of a table by name and version, ``my_linings@3``; None where there is none."""
        match = REFERENCE.fullmatch(reference)
        version = None if match is None else self.catalogue(tenant, match[1], int(match[2]))
        return None if version is None else text_of(version)

    def add_catalogue(
        self, tenant: int, name: str, table: str, csv: str, schema: str, rows: int, note: str = ""
    ) -> tuple[Catalogue, bool]:
        """Add a version of a table; return it, and whether it is new: the latest one with the same text stays it.

        Parameters
        ----------
        tenant : int
        name : str
            By which questions name it.
        table : str
            The table of a family that it is rows for.
        csv, schema : str
        rows : int
        note : str

        Raises
        ------
        InputError
            The name is none.
        """
        if not NAME.fullmatch(name):
            expected = "up to 60 letters, digits, _, . or -, the first a letter, digit or _"
            raise InputError("name", name, expected, ("name",))
        digest = TableText(reference=name, csv=csv, schema=schema).digest
        while True:
            latest = self.catalogue(tenant, name)
            if latest is not None and latest.digest == digest and latest.table == table:
                return latest, False
            new = {
                "tenant": tenant,
                "name": name,
                "version": 1 if latest is None else latest.version + 1,
                "table": table,
                "digest": digest,
                "rows": rows,
                "content": gzip.compress(csv.encode(), mtime=0),
                "schema": gzip.compress(schema.encode(), mtime=0),
                "note": note,
            }
            try:
                with self._engine.begin() as connection:
                    connection.execute(sa.insert(Catalogue).values(**new))
            except IntegrityError:
                continue  # somebody has added a version at the same time
            added = self.catalogue(tenant, name, int(str(new["version"])))
            assert added is not None
            return added, True

    def uses(self, tenant: int, reference: str) -> list[str]:
        """Return the jobs of a tenant that name a version of a table."""
        with Session(self._engine) as session:
            query = sa.select(Job.id, Job.request).where(
                Job.tenant == tenant, sa.cast(Job.request, sa.Text).contains(reference, autoescape=True)
            )
            return [job for job, request in session.execute(query) if reference in mentioned(request).tables]

    def remove_catalogue(self, tenant: int, name: str, version: int) -> bool:
        """Remove a version of a table; tell whether there was one."""
        conditions = (Catalogue.tenant == tenant, Catalogue.name == name, Catalogue.version == version)
        with self._engine.begin() as connection:
            return connection.execute(sa.delete(Catalogue).where(*conditions)).rowcount == 1

    # -- files ---------------------------------------------------------------------------------

    def add_upload(self, tenant: int, name: str, content: bytes, keep: float) -> str:
        """Keep a file for some seconds; return its id."""
        upload = new_id()
        record = Record(name=name, media="", content=content)
        with self._engine.begin() as connection:
            connection.execute(
                sa.insert(Upload).values(
                    id=upload,
                    tenant=tenant,
                    name=name,
                    size=len(content),
                    digest=record.digest,
                    content=content,
                    expires=moment() + keep,
                )
            )
        return upload

    def upload(self, tenant: int, upload: str) -> Upload | None:
        """Return a file; None where there is none, or no more."""
        with Session(self._engine, expire_on_commit=False) as session:
            query = sa.select(Upload).where(Upload.id == upload, Upload.tenant == tenant, Upload.expires > moment())
            return session.scalar(query)

    # -- what requests refer to ----------------------------------------------------------------

    def sources(self, tenant: int, request: object) -> Sources:
        """Objects that a request refers to by name, as far as the tenant has them; others report what is missing.

        Parameters
        ----------
        tenant : int
        request : mapping
        """
        tables: dict[str, TableText] = {}
        records: dict[str, Mapping[str, bytes]] = {}
        self._collect(tenant, request, tables, records, DEPTH)
        uploads = {name: self.upload(tenant, name) for name in mentioned(request).files}
        files = {name: Record(name=file.name, media="", content=file.content) for name, file in uploads.items() if file}
        database = self._engine.url.render_as_string(hide_password=False)
        return Sources(tables=tables, records=records, files=files, database=database)

    def _collect(
        self,
        tenant: int,
        request: object,
        tables: dict[str, TableText],
        records: dict[str, Mapping[str, bytes]],
        depth: int,
    ) -> None:
        named = mentioned(request)
        tables.update(self._texts(tenant, named.tables))
        for job in named.jobs if depth else ():
            source_job = self._queue.job(job, tenant)
            if source_job is not None and job not in records:
                kept = self._queue.records(job)
                records[job] = {name: record.content for name, record in kept.items()}
                self._collect(tenant, source_job.request, tables, records, depth - 1)

    def _texts(self, tenant: int, references: Iterable[str]) -> dict[str, TableText]:
        texts = {reference: self.table_text(tenant, reference) for reference in references}
        return {reference: text for reference, text in texts.items() if text is not None}


def text_of(catalogue: Catalogue) -> TableText:
    """Return the text of a version of a table."""
    return TableText(
        reference=f"{catalogue.name}@{catalogue.version}",
        csv=gzip.decompress(catalogue.content).decode(),
        schema=gzip.decompress(catalogue.schema).decode(),
    )
