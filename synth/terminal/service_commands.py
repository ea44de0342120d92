"""The commands of the service: serve, token, tenant, database, and pruning of jobs."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from datetime import UTC, datetime
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from synth.errors import InputError
from synth.system.operating_system import private_folder
from synth.terminal.batch_commands import jobs_app
from synth.terminal.session import INTERNAL, tell
from synth.text.numbers import typed_number

if TYPE_CHECKING:
    from synth.queue.accounts import TenantLimits, TokenEntry
    from synth.queue.database import Database
    from synth.service.settings import ServiceSettings

PACKAGES = ("fastapi", "uvicorn", "httptools", "jinja2", "python_multipart", "prometheus_client", "defusedxml")
DATABASE = "--database"  # the field of what is wrong with a database
LIMITS = ("open_jobs", "running", "seconds_limit", "rows")  # of a tenant, as they are kept
NO_LIMIT, MOST = "none", "N|none"
LARGEST_LIMIT = 2**53

Config = Annotated[
    Path | None,
    typer.Option(
        help="Settings, TOML; by default clutchsynth.toml where this folder has one.",
        metavar="FILE",
        show_default=False,
    ),
]
Data = Annotated[Path | None, typer.Option(help="Folder of the service's database.", metavar="DIR")]
ServiceDatabase = Annotated[
    str | None,
    typer.Option(
        "--database", help="Database: sqlite:///FILE or postgresql://USER@HOST/NAME; else a file in DIR.", metavar="URL"
    ),
]
TokenName = Annotated[str, typer.Argument(help="Number or first letters of a token, as list shows.", metavar="TOKEN")]

token_app = typer.Typer(help="Make, list and revoke tokens.", no_args_is_help=True, rich_markup_mode=None)
tenant_app = typer.Typer(help="List tenants, and change their limits.", no_args_is_help=True, rich_markup_mode=None)
database_app = typer.Typer(
    help="Check, back up and migrate a job database.", no_args_is_help=True, rich_markup_mode=None
)


def register(app: typer.Typer) -> None:
    """Add the commands to the command line."""
    app.command(name="serve")(serve)
    app.add_typer(token_app, name="token")
    app.add_typer(tenant_app, name="tenant")
    app.add_typer(database_app, name="database")
    jobs_app.command(name="prune")(prune)


def serve(
    host: Annotated[
        str | None, typer.Option(help="Address to listen on; by default 127.0.0.1, this machine alone.")
    ] = None,
    port: Annotated[int | None, typer.Option(help="Port to listen on; by default 8350.")] = None,
    data: Data = None,
    database: ServiceDatabase = None,
    workers: Annotated[
        int | None, typer.Option(help="Jobs that this machine works at side by side; by default one per core.")
    ] = None,
    no_workers: Annotated[bool, typer.Option("--no-workers", help="Leave the work to workers elsewhere.")] = False,
    config: Config = None,
) -> None:
    """Serve over HTTP until stopped, and work at the jobs that are asked for."""
    missing = next((package for package in PACKAGES if find_spec(package) is None), None)
    if missing is not None:
        raise InputError(f"the package {missing}", None, "the extra of the service: pip install 'clutchsynth[service]'")
    if no_workers and workers is not None:
        raise InputError("--no-workers", workers, "either --workers or --no-workers")
    from synth.service.serve import serve as run

    with _settings(config, data, database, host, port, 0 if no_workers else workers) as settings:
        run(settings, lambda sentence: print(sentence, flush=True))


@contextmanager
def _settings(
    config: Path | None,
    data: Path | None,
    database: str | None,
    host: str | None = None,
    port: int | None = None,
    workers: int | None = None,
) -> Iterator[ServiceSettings]:
    """Give the settings of the service, as file, variables and flags state them.

    What is wrong with a database that nobody has named is told of the folder that holds it.
    """
    from synth.service.settings import read_settings

    stated = {"data": data, "database": database, "host": host, "port": port, "workers": workers}
    if data is not None and database is None:
        stated["database"] = ""  # the folder says where it is
    settings = read_settings(config, os.environ, stated)
    try:
        yield settings
    except InputError as fault:
        if fault.field != DATABASE or settings.database:
            raise
        raise InputError("--data", fault.value, fault.expected, fault.path) from fault


# ---- tokens ---------------------------------------------------------------------------------------------------------


@token_app.command(name="create")
def create_token(
    name: Annotated[str, typer.Argument(help="Whom or what it is for.", metavar="NAME")],
    scopes: Annotated[
        str, typer.Option("--scopes", help="What it may do: read, submit, admin.", metavar="SCOPE,...")
    ] = "read,submit",
    tenant: Annotated[
        str, typer.Option(help="Whose jobs it sees; made where there is none of that name.", metavar="NAME")
    ] = "local",
    days: Annotated[float | None, typer.Option(help="For which it is valid; 0 for ever, by default a year.")] = None,
    data: Data = None,
    database: ServiceDatabase = None,
    config: Config = None,
) -> None:
    """Make a token, and show it this once."""
    from synth.queue.accounts import Accounts
    from synth.queue.database import Database

    if days is not None and days < 0:
        raise InputError("--days", days, "0 or more")
    with _settings(config, data, database) as settings, Database(_place(settings)) as opened:
        wanted = settings.token_days if days is None else days
        accounts = Accounts(opened)
        owner = accounts.tenant(tenant, settings.tenant_limits)
        asked = [scope.strip() for scope in scopes.split(",") if scope.strip()]
        made = accounts.make_token(name, owner, asked, wanted or None)
    print(made.value)
    tell(f"token {made.id} of {tenant}; it is shown this once, only its hash is kept")


@token_app.command(name="list")
def list_tokens(data: Data = None, database: ServiceDatabase = None, config: Config = None) -> None:
    """List the tokens, also those that are not valid any more."""
    from synth.queue.accounts import Accounts

    with _opened(config, data, database) as opened:
        found = Accounts(opened).tokens()
    heads = ("token", "begins", "tenant", "scopes", "created", "used", "expires", "name")
    _print_table([heads, *map(_line, found)])


@token_app.command(name="revoke")
def revoke_token(token: TokenName, data: Data = None, database: ServiceDatabase = None, config: Config = None) -> None:
    """Revoke a token; whoever uses it is nobody from now on."""
    from synth.queue.accounts import Accounts

    with _opened(config, data, database) as opened:
        accounts = Accounts(opened)
        found = accounts.find(token)
        if not accounts.revoke(found.id):
            raise InputError("TOKEN", token, "a token that is not revoked yet")
    print(f"token {found.id} ({found.name}): revoked")


def _line(token: TokenEntry) -> tuple[str, ...]:
    from synth.queue.log_lines import BEGINNING

    end = "revoked" if token.revoked is not None else _day(token.expires)
    days = (_day(token.created), _day(token.used), end)
    return (str(token.id), BEGINNING + token.prefix, token.tenant, ",".join(token.scopes), *days, token.name)


def _day(moment: float | None) -> str:
    return "-" if moment is None else datetime.fromtimestamp(moment, UTC).strftime("%Y-%m-%d")


@contextmanager
def _opened(config: Path | None, data: Path | None, database: str | None) -> Iterator[Database]:
    """Give a database that must be there."""
    from synth.queue.database import Database

    with _settings(config, data, database) as settings, Database(settings.database_url, create=False) as opened:
        yield opened


def _print_table(rows: Sequence[Sequence[str]]) -> None:
    """Print rows, the first with the names of the columns, one below the other."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        print("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())


def _place(settings: ServiceSettings) -> str:
    """Return the address of a database that may be made."""
    if not settings.database:
        private_folder(settings.data)
    return settings.database_url


# ---- tenants --------------------------------------------------------------------------------------------------------


@tenant_app.command(name="list")
def list_tenants(data: Data = None, database: ServiceDatabase = None, config: Config = None) -> None:
    """List the tenants, and what each may have at most."""
    from synth.queue.accounts import Accounts

    with _opened(config, data, database) as opened:
        found = Accounts(opened).tenants()
    heads = ("tenant", *(name.replace("_", "-") for name in LIMITS), "created")
    _print_table([heads, *((one.name, *_limits(one.limits), _day(one.created or None)) for one in found)])


@tenant_app.command(name="limit")
def limit_tenant(
    tenant: Annotated[str, typer.Argument(help="Name of the tenant, as list shows.", metavar="TENANT")],
    open_jobs: Annotated[str | None, typer.Option(help="Jobs that may be open at a time.", metavar=MOST)] = None,
    running: Annotated[str | None, typer.Option(help="Jobs that are worked at at a time.", metavar=MOST)] = None,
    seconds_limit: Annotated[str | None, typer.Option(help="Time limit of a job, in s.", metavar=MOST)] = None,
    rows: Annotated[str | None, typer.Option(help="Rows of a batch.", metavar=MOST)] = None,
    data: Data = None,
    database: ServiceDatabase = None,
    config: Config = None,
) -> None:
    """Change what a tenant may have at most, from the next request on; the rest stays as it is."""
    from synth.queue.accounts import Accounts

    stated = {"open_jobs": open_jobs, "running": running, "seconds_limit": seconds_limit, "rows": rows}
    wanted = {name: _most(name, text) for name, text in stated.items() if text is not None}
    if not wanted:
        flags = ", ".join(f"--{name.replace('_', '-')}" for name in stated)
        raise InputError("limits", None, f"at least one of {flags}")
    with _opened(config, data, database) as opened:
        found = Accounts(opened).limit(tenant, wanted)
    told = zip((name.replace("_", "-") for name in LIMITS), _limits(found), strict=True)
    print(f"{tenant}: {', '.join(f'{name} {most}' for name, most in told)}")


def _most(name: str, text: str) -> float | None:
    """Return a limit as it is stated: a number, or that there is none."""
    if text == NO_LIMIT:
        return None
    whole = name != "seconds_limit"
    try:
        found = int(text) if whole else float(text)
    except ValueError:
        found = 0
    if not 0 < found < LARGEST_LIMIT:
        right = f"a {'whole ' if whole else ''}number above 0, or {NO_LIMIT}"
        raise InputError(f"--{name.replace('_', '-')}", text, right)
    return found


def _limits(found: TenantLimits) -> list[str]:
    return [NO_LIMIT if (most := getattr(found, name)) is None else typed_number(most) for name in LIMITS]


# ---- the database ---------------------------------------------------------------------------------------------------


@database_app.command(name="check")
def check_database(data: Data = None, database: ServiceDatabase = None, config: Config = None) -> None:
    """Look a database over; nothing is changed."""
    from synth.queue.database import HEAD, way_back
    from synth.queue.maintenance import examine

    with _settings(config, data, database) as settings:
        found = examine(settings.database_url)
    for fault in found.faults:
        print(f"damaged: {fault}")
    if found.faults:
        print(way_back(found.file))
    elif not found.current:
        print(f"tables of version {found.version or 'none'}; this program uses {HEAD}: clutchsynth database migrate")
    if found.faults or not found.current:
        raise typer.Exit(INTERNAL)
    print(f"{found.url}: whole, tables of version {found.version}")


@database_app.command(name="backup")
def back_up_database(
    file: Annotated[Path, typer.Argument(help="Where the copy goes.", metavar="FILE")],
    data: Data = None,
    database: ServiceDatabase = None,
    config: Config = None,
) -> None:
    """Copy a database into a file, while it is used."""
    from synth.queue.maintenance import back_up

    with _settings(config, data, database) as settings:
        back_up(settings.database_url, file)
    print(f"written to {file}")


@database_app.command(name="migrate")
def migrate_database(data: Data = None, database: ServiceDatabase = None, config: Config = None) -> None:
    """Bring the tables of a database to the form that this version uses."""
    from synth.queue.maintenance import bring_up

    with _settings(config, data, database) as settings:
        before, after = bring_up(_place(settings))
    print(f"tables of version {after}, as before" if before == after else f"tables of version {after}")


def prune(data: Data = None, database: ServiceDatabase = None, config: Config = None) -> None:
    """Remove jobs whose time is over, apart from pinned ones, and files that nobody has used."""
    from synth.batches.store import Store

    count = 0
    with _settings(config, data, database) as settings, Store(settings.database_url, create=False) as store:
        while gone := store.prune(settings.prune_most):
            count += gone
    print("1 job removed" if count == 1 else f"{count} jobs removed")
