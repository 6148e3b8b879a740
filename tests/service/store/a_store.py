"""What the store's tests share: coefficient sets that differ, and one that is certified."""

from datetime import UTC, datetime
from typing import Any

import numpy as np

from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.recording.header import CameraHeader
from service.store.actor import Actor
from service.store.records import SetRecord
from service.store.store import Store
from tests.calib.radiometric.example_set import example_set

SETTING: dict[str, Any] = {"serial": "B0001", "band": "NIR", "gain_db": 0.0, "bit_depth": 12}


def a_set(dark_offset_dn: float = 30.0, **camera: Any) -> CoefficientSet:
    """Return a set that differs from others by its offset, or its camera."""
    header = {"serial": "B0001", "columns": 32, "bit_depth": 12, "band": "NIR", **camera}
    return example_set(
        dark_offset_dn=np.full(32, dark_offset_dn), camera=CameraHeader.model_validate(header)
    )


def day(month: int, of_month: int = 1) -> datetime:
    """Return a day of 2026, UTC."""
    return datetime(2026, month, of_month, tzinfo=UTC)


def verified(store: Store, coefficients: CoefficientSet) -> SetRecord:
    """Add a set and verify it."""
    added = store.sets.add(coefficients, by=Actor("ada"))
    return store.sets.verify(added.id, by=Actor("ada"), reason="curves look right")


def certified(
    store: Store,
    coefficients: CoefficientSet,
    valid_from: datetime,
    valid_until: datetime | None = None,
    **more: Any,
) -> SetRecord:
    """Add, verify and certify a set."""
    return store.sets.certify(
        verified(store, coefficients).id,
        valid_from=valid_from,
        valid_until=valid_until,
        by=Actor("grace"),
        reason="annual calibration",
        **more,
    )


def take_step(store: Store, set_id: str, step: str) -> SetRecord:
    """Verify, certify or revoke a set."""
    match step:
        case "verify":
            return store.sets.verify(set_id, by=Actor("ada"))
        case "certify":
            return store.sets.certify(
                set_id, valid_from=day(1), valid_until=None, by=Actor("ada"), reason="due"
            )
        case _:
            return store.sets.revoke(set_id, by=Actor("ada"), reason="wrong")
