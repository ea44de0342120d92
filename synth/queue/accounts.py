"""Who may see and do what: tenants, the tokens that prove who somebody is, and browsers that have shown one.

Of a token and of the cookie of a browser only hashes are kept: whoever reads the database cannot act for anybody.
"""

from __future__ import annotations

import hashlib
import hmac
import re
import secrets
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

import sqlalchemy as sa
from sqlalchemy.exc import IntegrityError

from synth.errors import InputError
from synth.queue.database import Database
from synth.queue.job_table import LOCAL
from synth.queue.log_lines import BEGINNING
from synth.queue.models import BrowserSession, Tenant, Token, moment
from synth.text.plain_text import UNSAFE_IN_LINE

READ, SUBMIT, ADMIN = "read", "submit", "admin"
SCOPES = (READ, SUBMIT, ADMIN)
RANDOM = 32  # bytes of a token, and of the cookie of a browser
PREFIX_LETTERS = 8  # of a token that are kept, to find it by and to tell it apart
NAME = 60  # letters of a name at most
# Neither characters that act on whatever shows them nor blanks alone.
NAME_PATTERN = rf"^[^{UNSAFE_IN_LINE}\u0020\u00a0][^{UNSAFE_IN_LINE}]*$"
TENANT = re.compile(r"[^\W_][\w.-]*")  # names that programs, addresses and folders can repeat as they are
HALF = re.compile(r"[\ud800-\udfff]")  # of a letter: what no database keeps
LONGEST_TOKEN = 100  # letters; what is longer is none, and is not even hashed


@dataclass(frozen=True, kw_only=True)
class TenantLimits:
    """What a tenant may have at most; None is no limit.

    Parameters
    ----------
    open_jobs, running : int or None
        Jobs that are open, and that are worked at, at a time.
    seconds_limit : float or None
        Time limit of a job.
    rows : int or None
        Rows of a batch.
    """

    open_jobs: int | None = None
    running: int | None = None
    seconds_limit: float | None = None
    rows: int | None = None

    @classmethod
    def of(cls, kept: Mapping[str, Any]) -> TenantLimits:
        """Return the limits that a tenant is kept with; what other versions know besides is theirs."""
        return cls(**{limit.name: kept.get(limit.name) for limit in fields(cls)})


@dataclass(frozen=True, kw_only=True)
class Principal:
    """Who has been recognised, and what they may do.

    Parameters
    ----------
    tenant : int
    tenant_name : str
    scopes : frozenset of str
        ``read``, ``submit``, ``admin``.
    token : int or None
        Number of the token; None for everybody at a machine where no tokens are needed.
    limits : TenantLimits
    used : float or None
        How many s ago the last use of the token was noted.
    session : str or None
        Hash of the cookie of a browser that has shown the token.
    """

    tenant: int
    tenant_name: str
    scopes: frozenset[str]
    token: int | None
    limits: TenantLimits
    used: float | None = None
    session: str | None = None


@dataclass(frozen=True, kw_only=True)
class NewToken:
    """A token that has just been made; ``value`` is shown this once."""

    id: int
    value: str
    prefix: str


@dataclass(frozen=True, kw_only=True)
class TokenEntry:
    """A token as lists show it. Times are seconds since 1970, on the clock of the database."""

    id: int
    name: str
    prefix: str
    tenant: str
    scopes: tuple[str, ...]
    created: float
    expires: float | None
    used: float | None
    revoked: float | None


@dataclass(frozen=True, kw_only=True)
class TenantEntry:
    """A tenant as lists show it. Times are seconds since 1970, on the clock of the database."""

    name: str
    limits: TenantLimits
    created: float


class Accounts:
    """The tenants and tokens of a job database.

    Parameters
    ----------
    database : Database
    """

    def __init__(self, database: Database) -> None:
        self.engine = database.engine

    # -- tenants -------------------------------------------------------------------------------

    def tenant(self, name: str, limits: Mapping[str, object]) -> int:
        """Return the number of a tenant; one that is new gets these limits.

        Raises
        ------
        InputError
            There is none of that name, and it is no name for a new one.
        """
        right = f"a name of at most {NAME} letters, digits, -, _ or ., the first a letter or digit"
        if not _can_be_shown(name):
            raise InputError("tenant", name, right, ("tenant",))
        for _ in range(2):
            with self.engine.begin() as connection:
                known = connection.scalar(sa.select(Tenant.id).where(Tenant.name == name))
                if known is not None:
                    return int(known)
            if not TENANT.fullmatch(name):
                raise InputError("tenant", name, right, ("tenant",))
            try:
                with self.engine.begin() as connection:
                    new = {"name": name, "limits": dict(limits)}
                    made = connection.execute(sa.insert(Tenant).values(**new).returning(Tenant.id))
                    return int(made.scalar_one())
            except IntegrityError:  # somebody has made it at the same time
                continue
        raise InputError("tenant", name, "another name")

    def tenants(self) -> list[TenantEntry]:
        """Return all tenants, in the order in which they were made."""
        query = sa.select(Tenant.name, Tenant.limits, Tenant.created).order_by(Tenant.id)
        with self.engine.connect() as connection:
            return [
                TenantEntry(name=name, limits=TenantLimits.of(limits), created=created)
                for name, limits, created in connection.execute(query)
            ]

    def limit(self, name: str, changes: Mapping[str, float | None]) -> TenantLimits:
        """Change limits of a tenant that there is; return all that it has now.

        Parameters
        ----------
        name : str
        changes : mapping
            Fields of :class:`TenantLimits` -> what the tenant may have from now on; None is no limit.

        Raises
        ------
        InputError
            There is no such tenant.
        """
        with self.engine.begin() as connection:
            # Written before it is read: nobody else changes it in between.
            held = sa.update(Tenant).where(Tenant.name == name).values(created=Tenant.created).returning(Tenant.limits)
            known = connection.scalar(held)
            if known is not None:
                limits = {**known, **changes}
                connection.execute(sa.update(Tenant).where(Tenant.name == name).values(limits=limits))
                return TenantLimits.of(limits)
        names = ", ".join(entry.name for entry in self.tenants())
        raise InputError("tenant", name, f"one of {names}", ("tenant",))

    def local(self) -> Principal:
        """Return who everybody is where no tokens are needed: the tenant of the command line, who may do all."""
        with self.engine.connect() as connection:
            name, limits = connection.execute(sa.select(Tenant.name, Tenant.limits).where(Tenant.id == LOCAL)).one()
        return Principal(
            tenant=LOCAL, tenant_name=name, scopes=frozenset(SCOPES), token=None, limits=TenantLimits.of(limits)
        )

    # -- tokens --------------------------------------------------------------------------------

    def make_token(self, name: str, tenant: int, scopes: Iterable[str], days: float | None) -> NewToken:
        """Make a token.

        Parameters
        ----------
        name : str
            Whom or what it is for.
        tenant : int
        scopes : iterable of str
            ``read``, ``submit``, ``admin``.
        days : float or None
            For which it is valid; None for ever.

        Raises
        ------
        InputError
            Name or scopes are wrong.
        """
        if not _can_be_shown(name):
            right = f"a name of at most {NAME} letters in one line, which does not begin with a blank"
            raise InputError("name", name, right, ("name",))
        requested = set(scopes)
        if not requested or not requested <= set(SCOPES):
            shown = ",".join(sorted(requested)) or None
            raise InputError("scopes", shown, f"one or more of {', '.join(SCOPES)}", ("scopes",))
        value = BEGINNING + secrets.token_urlsafe(RANDOM)
        prefix = _prefix(value)
        columns = {
            "tenant": tenant,
            "name": name,
            "prefix": prefix,
            "hash": _hash(value),
            "scopes": " ".join(scope for scope in SCOPES if scope in requested),
            "expires": None if days is None else moment() + 86400.0 * days,
        }
        with self.engine.begin() as connection:
            made = connection.execute(sa.insert(Token).values(**columns).returning(Token.id)).scalar_one()
        return NewToken(id=int(made), value=value, prefix=prefix)

    def tokens(self) -> list[TokenEntry]:
        """Return all tokens that there are, or were."""
        query = (
            sa.select(
                Token.id,
                Token.name,
                Token.prefix,
                Tenant.name,
                Token.scopes,
                Token.created,
                Token.expires,
                Token.used,
                Token.revoked,
            )
            .join(Tenant, Tenant.id == Token.tenant)
            .order_by(Token.id)
        )
        with self.engine.connect() as connection:
            rows = connection.execute(query).all()
        return [
            TokenEntry(
                id=number,
                name=name,
                prefix=prefix,
                tenant=tenant,
                scopes=tuple(scopes.split()),
                created=created,
                expires=expires,
                used=used,
                revoked=revoked,
            )
            for number, name, prefix, tenant, scopes, created, expires, used, revoked in rows
        ]

    def revoke(self, token: int) -> bool:
        """Revoke a token, and sign out the browsers that have shown it; return False where there is none."""
        with self.engine.begin() as connection:
            connection.execute(sa.delete(BrowserSession).where(BrowserSession.token == token))
            done = connection.execute(
                sa.update(Token).where(Token.id == token, Token.revoked.is_(None)).values(revoked=moment())
            )
        return done.rowcount == 1

    def any_token(self) -> bool:
        """True if a token was ever made: from then on nobody is anybody without one.

        Revoked ones count: the last one revoked must not open the service for all.
        """
        with self.engine.connect() as connection:
            return connection.scalar(sa.select(Token.id).limit(1)) is not None

    def any_valid(self) -> bool:
        """True if somebody can get in with a token."""
        with self.engine.connect() as connection:
            return connection.scalar(sa.select(Token.id).where(*_valid()).limit(1)) is not None

    def recognise(self, value: str) -> Principal | None:
        """Return who shows a token; None where it is wrong, revoked or too old."""
        if not value.startswith(BEGINNING) or len(value) > LONGEST_TOKEN:
            return None
        digest = _hash(value)
        with self.engine.connect() as connection:
            query = _principals().add_columns(Token.hash).where(Token.prefix == _prefix(value), *_valid())
            for row in connection.execute(query):
                if hmac.compare_digest(row.hash, digest):
                    return _principal(row)
        return None

    def note_use(self, token: int) -> None:
        """Note that a token was used."""
        with self.engine.begin() as connection:
            connection.execute(sa.update(Token).where(Token.id == token).values(used=moment()))

    # -- browsers ------------------------------------------------------------------------------

    def sign_in(self, token: int, hours: float) -> str:
        """Let a browser be whoever has shown it this token; return the value of its cookie."""
        value = secrets.token_urlsafe(RANDOM)
        with self.engine.begin() as connection:
            connection.execute(sa.delete(BrowserSession).where(BrowserSession.expires < moment()))
            new = {"hash": _hash(value), "token": token, "expires": moment() + 3600.0 * hours}
            connection.execute(sa.insert(BrowserSession).values(**new))
        return value

    def browser(self, cookie: str) -> Principal | None:
        """Return who a browser is; None where it is nobody, or nobody any more."""
        if len(cookie) > LONGEST_TOKEN:
            return None
        digest = _hash(cookie)
        query = _principals().join(BrowserSession, BrowserSession.token == Token.id)
        with self.engine.connect() as connection:
            valid = (BrowserSession.hash == digest, BrowserSession.expires > moment(), *_valid())
            row = connection.execute(query.where(*valid)).one_or_none()
        return None if row is None else replace(_principal(row), session=digest)

    def lapsed(self, principals: Collection[Principal]) -> set[Principal]:
        """Accounts that would not be let in again: their token has ended, or they were or have signed out."""
        tokens = {one.token for one in principals if one.token is not None}
        sessions = {one.session for one in principals if one.session is not None}
        in_time = BrowserSession.expires > moment()
        with self.engine.connect() as connection:
            valid = set(connection.scalars(sa.select(Token.id).where(Token.id.in_(tokens), *_valid())))
            known = sa.select(BrowserSession.hash).where(BrowserSession.hash.in_(sessions), in_time)
            signed_in = set(connection.scalars(known))
        nobody_needs_one = not self.any_token()
        return {
            one
            for one in principals
            if not (nobody_needs_one if one.token is None else one.token in valid)
            or (one.session is not None and one.session not in signed_in)
        }

    def sign_out(self, cookie: str) -> None:
        """Forget a browser."""
        with self.engine.begin() as connection:
            connection.execute(sa.delete(BrowserSession).where(BrowserSession.hash == _hash(cookie)))

    def find(self, beginning: str) -> TokenEntry:
        """Return the token that is meant by its number, or by its first letters as lists show them.

        Raises
        ------
        InputError
            There is none, or several.
        """
        letters = beginning.removeprefix(BEGINNING)
        matches = [t for t in self.tokens() if str(t.id) == beginning or (letters and t.prefix.startswith(letters))]
        exact = [t for t in matches if str(t.id) == beginning]
        if len(exact or matches) != 1:
            raise InputError("TOKEN", beginning, "the number of a token, or its first letters, as token list shows")
        return (exact or matches)[0]


def _can_be_shown(name: str) -> bool:
    return len(name) <= NAME and re.fullmatch(NAME_PATTERN, name) is not None and HALF.search(name) is None


def _hash(value: str) -> str:
    return hashlib.sha256(value.encode("utf-8", "surrogatepass")).hexdigest()


def _prefix(value: str) -> str:
    return value.removeprefix(BEGINNING)[:PREFIX_LETTERS]


def _valid() -> tuple[sa.ColumnElement[bool], ...]:
    return Token.revoked.is_(None), sa.or_(Token.expires.is_(None), Token.expires > moment())


def _principals() -> sa.Select[Any]:
    used = (moment() - Token.used).label("used")
    return sa.select(Tenant.id, Tenant.name, Tenant.limits, Token.scopes, Token.id.label("token"), used).join(
        Tenant, Tenant.id == Token.tenant
    )


def _principal(row: sa.Row[Any]) -> Principal:
    return Principal(
        tenant=row.id,
        tenant_name=row.name,
        scopes=frozenset(row.scopes.split()),
        token=row.token,
        limits=TenantLimits.of(row.limits),
        used=row.used,
    )
