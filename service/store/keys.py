"""Keys: who may ask the service for what.

A key reads `dfk_<id>_<secret>`; the store holds the SHA-256 of the secret, which has 256 bits of
chance and therefore needs no slow hash (NIST SP 800-63B, 5.1.1.2 is about what people choose).
"""

import hashlib
import hmac
import secrets
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from enum import StrEnum
from typing import Final

from sqlalchemy import Engine, func, select
from sqlalchemy.orm import Session

from calib.errors import InputError
from service.store.actor import Actor
from service.store.audit import append
from service.store.engine import reading_session, writing_session
from service.store.errors import NotInStoreError
from service.store.tables import KeyRow
from service.store.utc import aware

PREFIX: Final = "dfk"


class Scope(StrEnum):
    """What a key allows; each includes those before it.

    An operator reads, a certifier operates: whoever says that a set holds may also take its data.
    """

    READ = "read"
    OPERATE = "operate"
    """Move the bench, record, calculate."""
    CERTIFY = "certify"
    """Say that a coefficient set holds."""
    ADMIN = "admin"
    """Keys, and what is deleted."""

    def includes(self, other: "Scope") -> bool:
        """Tell whether what needs `other` may be done with this one."""
        order = list(Scope)
        return order.index(self) >= order.index(other)


@dataclass(frozen=True)
class KeyRecord:
    """A key without its secret."""

    id: str
    name: str
    scope: Scope
    created_at: datetime
    expires_at: datetime | None
    revoked_at: datetime | None

    def is_good_at(self, at: datetime) -> bool:
        """Tell whether it opens anything at `at`."""
        return self.revoked_at is None and (self.expires_at is None or at < self.expires_at)


@dataclass(frozen=True)
class KeyBook:
    """All keys as they were on record at one moment.

    Attributes:
        by_id: Each key's record, and the SHA-256 of its secret.
    """

    by_id: Mapping[str, tuple[KeyRecord, str]]

    def known(self, key: str) -> KeyRecord | None:
        """Return the record of a key that is good now; None of any other text."""
        prefix, _, rest = key.partition("_")
        key_id, _, secret = rest.partition("_")
        record, stored = self.by_id.get(key_id, (None, ""))
        # Compared in any case: how long it takes tells nothing of which part was wrong.
        matches = hmac.compare_digest(stored.encode(), _digest(secret).encode())
        if record is None or prefix != PREFIX or not matches:
            return None
        return record if record.is_good_at(datetime.now(UTC)) else None


class Keys:
    """The keys; those that are over stay on record."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def create(
        self, name: str, scope: Scope, *, expires_at: datetime | None, by: Actor
    ) -> tuple[KeyRecord, str]:
        """Return a new key's record and the key itself, which nobody is told again."""
        if not name.strip():
            msg = "a key needs a name: say who or what uses it"
            raise InputError(msg, code="no-name")
        until = None if expires_at is None else aware(expires_at, "expires_at")
        if until is not None and until <= datetime.now(UTC):
            msg = f"the key would be over already at {until.isoformat()}; give a later time"
            raise InputError(msg, code="bad-validity")
        key_id, secret = secrets.token_hex(8), secrets.token_urlsafe(32)
        with writing_session(self._engine) as session:
            row = KeyRow(
                id=key_id, name=name, scope=scope.value, secret_sha256=_digest(secret),
                created_at=datetime.now(UTC), expires_at=until,
            )  # fmt: skip
            session.add(row)
            append(session, by, "key.create", key_id, after={"name": name, "scope": scope.value})
            return _record(row), f"{PREFIX}_{key_id}_{secret}"

    def read(self) -> KeyBook:
        """Return all keys as they are on record now."""
        with reading_session(self._engine) as session:
            rows: Iterable[KeyRow] = session.scalars(select(KeyRow))
            return KeyBook({row.id: (_record(row), row.secret_sha256) for row in rows})

    def known(self, key: str) -> KeyRecord | None:
        """Return the record of a key that is good now; None of any other text."""
        return self.read().known(key)

    def any(self) -> bool:
        """Tell whether a key was ever made: then none is served without one."""
        with reading_session(self._engine) as session:
            return bool(session.scalar(select(func.count()).select_from(KeyRow)))

    def list(self) -> tuple[KeyRecord, ...]:
        """Return all keys, oldest first."""
        with reading_session(self._engine) as session:
            rows: Iterable[KeyRow] = session.scalars(select(KeyRow).order_by(KeyRow.sequence))
            return tuple(_record(row) for row in rows)

    def revoke(self, key_id: str, *, by: Actor) -> KeyRecord:
        """End a key at once; one that is over stays as it is."""
        with writing_session(self._engine) as session:
            row = _find(session, key_id)
            if row.revoked_at is None:
                row.revoked_at = datetime.now(UTC)
                append(session, by, "key.revoke", key_id, before={"name": row.name})
            return _record(row)


def _find(session: Session, key_id: str) -> KeyRow:
    row = session.scalar(select(KeyRow).where(KeyRow.id == key_id))
    if row is None:
        msg = f"there is no key {key_id!r}; list them"
        raise NotInStoreError(msg)
    return row


def _digest(secret: str) -> str:
    return hashlib.sha256(secret.encode(errors="surrogatepass")).hexdigest()


def _record(row: KeyRow) -> KeyRecord:
    return KeyRecord(
        row.id, row.name, Scope(row.scope), row.created_at, row.expires_at, row.revoked_at
    )
