"""A coefficient set's metadata as plain values, and back."""

import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any, Protocol

from calib.budget import Budget, BudgetRow
from calib.radiometric.coefficients.column_state import ColumnState
from calib.radiometric.coefficients.departures import Departures
from calib.radiometric.coefficients.provenance import Domain, Provenance
from calib.radiometric.coefficients.transfer_reference import TransferReference
from calib.recording.header import CameraHeader

FORMAT = "darkflat coefficient set 1"

SCALARS = (
    "radiance_unit",
    "scale_relative_std",
    "system_gain_dn_per_e",
    "system_gain_dn_per_e_std",
    "read_noise_e",
    "read_noise_e_std",
    "axis_column",
    "axis_column_std",
    "vignette_order",
    "reduced_chi_squared",
)


class Described(Protocol):
    """What a coefficient set says beside its arrays; its scalars are named in SCALARS."""

    @property
    def camera(self) -> CameraHeader:
        """The camera, as set in the recording."""
        ...

    @property
    def domain(self) -> Domain:
        """What the calibration has seen."""
        ...

    @property
    def budget(self) -> Budget:
        """Of the responsivity."""
        ...

    @property
    def provenance(self) -> Provenance:
        """Where it comes from."""
        ...

    @property
    def transfer_function(self) -> TransferReference | None:
        """The pixel's transfer function, where one is attached."""
        ...

    @property
    def departures(self) -> Departures | None:
        """What was taken out of the calibration, where anything was."""
        ...


def to_metadata(coefficients: Described) -> dict[str, Any]:
    """Return everything but the arrays, ready for JSON; a number that is not known is None.

    What is optional is left out where there is none, so that a set keeps the id that it had before
    there was such a thing.
    """
    transfer, departures = coefficients.transfer_function, coefficients.departures
    return {
        "format": FORMAT,
        "reason_codes": {state.name.lower(): int(state) for state in ColumnState},
        "camera": coefficients.camera.content(),
        "domain": asdict(coefficients.domain),
        "budget": asdict(coefficients.budget),
        "provenance": asdict(coefficients.provenance),
        **{name: _finite(getattr(coefficients, name)) for name in SCALARS},
        **({} if transfer is None else {"transfer_function": asdict(transfer)}),
        **({} if departures is None else {"departures": asdict(departures)}),
    }


def from_metadata(metadata: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields of a `CoefficientSet` that are not arrays.

    Raises:
        KeyError, TypeError, ValueError: Where the metadata are not a coefficient set's.
    """
    if metadata["format"] != FORMAT:
        raise ValueError(metadata["format"])
    domain, budget = metadata["domain"], metadata["budget"]
    ranges: dict[str, Any] = {k: None if v is None else tuple(v) for k, v in domain.items()}
    rows = tuple(BudgetRow(**row) for row in budget["rows"])
    return {
        "camera": CameraHeader(**metadata["camera"]),
        "domain": Domain(**ranges),
        "budget": Budget(**{**budget, "rows": rows}),
        "provenance": Provenance(**metadata["provenance"]),
        **{name: _unknown(name, metadata[name]) for name in SCALARS},
        "transfer_function": _transfer(metadata.get("transfer_function")),
        "departures": _departures(metadata.get("departures")),
    }


def _transfer(told: Mapping[str, Any] | None) -> TransferReference | None:
    if told is None:
        return None
    pairs: dict[str, Any] = {
        key: tuple(each) if isinstance(each, list) else each for key, each in told.items()
    }
    return TransferReference(**pairs)


def _departures(told: Mapping[str, Any] | None) -> Departures | None:
    if told is None:
        return None
    return Departures(**{**told, "cannot_be_undone": tuple(told["cannot_be_undone"])})


def _finite(value: Any) -> Any:
    """Return None for a number that JSON does not know."""
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _unknown(name: str, value: Any) -> Any:
    """Return NaN for a scalar that has to be a number but was not known."""
    optional = name in {"axis_column_std", "reduced_chi_squared"}
    return math.nan if value is None and not optional else value
