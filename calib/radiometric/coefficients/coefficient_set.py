"""The coefficient set: what turns a camera's DN into radiance, and how well.

Source: Olsen et al. 2010 (AgCam), Eq. 1: DN(i) = L(i)·VE(i)·QE(i)·t + DN0(i).
"""

from dataclasses import dataclass, fields, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.budget import Budget
from calib.errors import InputError
from calib.radiometric.coefficients.coefficient_metadata import from_metadata, to_metadata
from calib.radiometric.coefficients.column_state import ColumnState
from calib.radiometric.coefficients.departures import Departures
from calib.radiometric.coefficients.provenance import Domain, Provenance
from calib.radiometric.coefficients.transfer_reference import TransferReference
from calib.recording import content_addressed
from calib.recording.header import CameraHeader


@dataclass(frozen=True, eq=False)
class CoefficientSet:
    """Immutable; `id` names the content. Arrays are (n_columns,), read-only.

    Where a column is not valid its slope and responsivity are NaN. Every `_std` is a standard
    uncertainty (k = 1).

    Attributes:
        camera: The camera, as set in the recording.
        radiance_unit: Unit of L; "1" where the scale is relative.
        dark_offset_dn: DN0, the regression's intercept at exposure 0, DN.
        dark_offset_dn_std: Its uncertainty, DN.
        vignette: VE, the smooth optical profile, 1 at the axis.
        vignette_std: Its uncertainty; 0 at the axis, where VE is 1 by definition.
        responsivity: QE, DN per radiance per µs.
        responsivity_std: Its uncertainty, the scale's included.
        slope: VE·QE, DN per radiance per µs: what `apply` divides by.
        slope_std: Its uncertainty without the scale's, which all columns share.
        offset_slope_covariance: Of DN0 and slope, DN² per radiance per µs.
        dark_current_dn_per_us: What the dark level grows by; 0 where no two exposures tell.
        dark_current_dn_per_us_std: Its uncertainty.
        reason: `ColumnState` of each column, uint8.
        scale_relative_std: Relative uncertainty of the radiance scale, common to all columns.
        system_gain_dn_per_e: DN per electron.
        system_gain_dn_per_e_std: Its uncertainty.
        read_noise_e: Temporal noise in the dark without rounding, electrons.
        read_noise_e_std: Its uncertainty.
        axis_column: Where VE is largest, 0-based.
        axis_column_std: Its uncertainty, columns; None where the maximum is at an end of the line.
        vignette_order: Degree of the polynomial.
        reduced_chi_squared: Of the columns' lines, pooled.
        domain: What the calibration has seen.
        budget: Of the responsivity, relative.
        provenance: Where it comes from.
        transfer_function: The pixel's transfer function, where one was measured and attached.
        departures: What was taken out of the calibration, and is taken out of lines; None where
            the response is all there is.
    """

    camera: CameraHeader
    radiance_unit: str
    dark_offset_dn: Columns
    dark_offset_dn_std: Columns
    vignette: Columns
    vignette_std: Columns
    responsivity: Columns
    responsivity_std: Columns
    slope: Columns
    slope_std: Columns
    offset_slope_covariance: Columns
    dark_current_dn_per_us: Columns
    dark_current_dn_per_us_std: Columns
    reason: NDArray[np.uint8]
    scale_relative_std: float
    system_gain_dn_per_e: float
    system_gain_dn_per_e_std: float
    read_noise_e: float
    read_noise_e_std: float
    axis_column: float
    axis_column_std: float | None
    vignette_order: int
    reduced_chi_squared: float | None
    domain: Domain
    budget: Budget
    provenance: Provenance
    transfer_function: TransferReference | None = None
    departures: Departures | None = None

    def __post_init__(self) -> None:
        for name in self.array_names():
            array = np.array(getattr(self, name))
            if array.shape != (self.camera.columns,):
                message = f"{name} has shape {array.shape}, not ({self.camera.columns},)."
                raise InputError(message, code="wrong-shape")
            array.flags.writeable = False
            object.__setattr__(self, name, array)

    @classmethod
    def array_names(cls) -> tuple[str, ...]:
        """Return the names of the per-column fields."""
        return tuple(f.name for f in fields(cls) if f.type in {Columns, NDArray[np.uint8]})

    @property
    def n_columns(self) -> int:
        """How many columns there are."""
        return self.camera.columns

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Which columns can be used, (n_columns,)."""
        return np.equal(self.reason, ColumnState.VALID)

    @cached_property
    def id(self) -> str:
        """SHA-256 over arrays and canonical metadata, 64 hexadecimal digits."""
        return content_addressed.content_id(self._arrays(), to_metadata(self))

    def dark_level_dn(self, exposure_us: float) -> Columns:
        """Return what the column reads in the dark: DN0 and the dark current, DN."""
        return self.dark_offset_dn + self.dark_current_dn_per_us * exposure_us

    def with_transfer_function(self, transfer: TransferReference) -> "CoefficientSet":
        """Return a set that carries `transfer`: other content, and so another id."""
        return replace(self, transfer_function=transfer)

    def save(self, path: Path | str) -> None:
        """Write the set to `path` (HDF5), whole or not at all.

        Raises:
            InputError: `cannot-write` where the file cannot be written.
        """
        content_addressed.write(Path(path), self._arrays(), to_metadata(self))

    @classmethod
    def load(cls, path: Path | str) -> Self:
        """Read a set and verify its id.

        Raises:
            InputError: `not-found`, `not-a-coefficient-set` or `altered`.
        """
        arrays, metadata = content_addressed.read(Path(path))
        try:
            columns: dict[str, Any] = {name: arrays[name] for name in cls.array_names()}
            return cls(**columns, **from_metadata(metadata))
        except (KeyError, TypeError, ValueError) as error:
            message = f"{path} is not a coefficient set of this version: calibrate again."
            raise InputError(message, code="not-a-coefficient-set") from error

    def summary(self) -> dict[str, Any]:
        """Return the figures that a person asks for first, ready for JSON."""
        at_axis = self.axis_index
        return {
            "coefficient_set": self.id,
            "camera": self.camera.model_dump(mode="json", exclude_none=True),
            "columns": self.n_columns,
            "valid_columns": int(self.valid.sum()),
            "masked": {
                s.name.lower(): int((self.reason == s).sum())
                for s in ColumnState
                if s != ColumnState.VALID and (self.reason == s).any()
            },
            "mean_dark_offset_dn": float(np.mean(self.dark_offset_dn[self.valid])),
            "vignette_order": self.vignette_order,
            "axis_column": self.axis_column,
            "axis_column_std": self.axis_column_std,
            "edge_fall_percent": self.edge_fall_percent,
            "responsivity_at_axis": {
                "value": float(self.responsivity[at_axis]),
                "std": float(self.responsivity_std[at_axis]),
                "unit": f"DN / ({self.radiance_unit} µs)",
            },
            "scale_relative_std": self.scale_relative_std,
            "system_gain_dn_per_e": self.system_gain_dn_per_e,
            "read_noise_e": self.read_noise_e,
            "reduced_chi_squared": self.reduced_chi_squared,
        }

    @property
    def axis_index(self) -> int:
        """The valid column that is nearest to the axis."""
        usable = np.flatnonzero(self.valid)
        return int(usable[np.argmin(np.abs(usable - self.axis_column))])

    @property
    def edge_fall_percent(self) -> float:
        """How far VE falls towards the edge where it falls further, percent."""
        return float(100.0 * (1.0 - min(self.vignette[0], self.vignette[-1])))

    def _arrays(self) -> dict[str, NDArray[Any]]:
        """Return what the file holds by column; `valid` is there for other people's readers."""
        arrays = {name: getattr(self, name) for name in self.array_names()}
        return {**arrays, "valid": self.valid.astype(np.uint8)}
