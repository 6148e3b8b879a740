"""Bringing the database to the schema that this version knows."""

from pathlib import Path
from typing import TYPE_CHECKING

from sqlalchemy import Connection, Engine, inspect, text

from service.store.database_errors import store_errors
from service.store.engine import writing
from service.store.errors import StoreError

if TYPE_CHECKING:
    from alembic.config import Config

HEAD = "0003"
"""The newest revision in `migrations/versions`."""

MIGRATIONS = Path(__file__).parent / "migrations"


def migrate(engine: Engine) -> None:
    """Upgrade to `HEAD`, in one transaction; several processes may do so at once.

    Raises:
        StoreError: `store-too-new` where a newer darkflat has been here.
    """
    with store_errors():
        with engine.connect() as connection:
            if _revision(connection) == HEAD:
                return
        with writing(engine).begin() as connection:
            _upgrade(connection)


def check_current(engine: Engine) -> None:
    """Raise StoreError unless the schema is this version's: `no-store`, `store-too-old`."""
    with store_errors(), engine.connect() as connection:
        found = _revision(connection)
    if found is None:
        msg = "there is no store yet; it is made by the first command that keeps something"
        raise StoreError(msg, code="no-store")
    if found != HEAD:
        msg = f"the store is of another version ({found}, not {HEAD}); darkflat store list brings"
        raise StoreError(f"{msg} an older one up to date", code="store-too-old")


def _revision(connection: Connection) -> str | None:
    if not inspect(connection).has_table("alembic_version"):
        return None
    found: str | None = connection.scalar(text("SELECT version_num FROM alembic_version"))
    return found


def _upgrade(connection: Connection) -> None:
    from alembic import command  # noqa: PLC0415  (0.2 s that a current store does not need)
    from alembic.util import CommandError  # noqa: PLC0415

    try:
        command.upgrade(alembic_config(connection), "head")
    except CommandError as error:
        msg = f"the store was written by a newer darkflat ({error}); upgrade this one"
        raise StoreError(msg, code="store-too-new") from error


def alembic_config(connection: Connection) -> "Config":
    """Return what Alembic's commands need to work on this connection."""
    from alembic.config import Config  # noqa: PLC0415

    config = Config()
    config.set_main_option("script_location", str(MIGRATIONS).replace("%", "%%"))
    config.attributes["connection"] = connection
    return config
