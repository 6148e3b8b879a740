"""Lines in radiance: what a correction returns."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.errors import InputError
from calib.kernels import radiance as kernel


@dataclass(frozen=True)
class Radiance:
    """Lines in radiance, each array (n_lines, n_columns).

    Attributes:
        radiance: float32, in the set's unit; NaN in masked columns, negative below black.
        std: float32, standard uncertainty (k = 1) of each single sample, the scale's included; NaN
            in masked columns, infinite where saturated. None where not asked for.
        flags: uint8, bits of `Flag`.
    """

    radiance: NDArray[np.float32]
    std: NDArray[np.float32] | None
    flags: NDArray[np.uint8]

    @classmethod
    def empty(cls, n_lines: int, n_columns: int, *, std: bool = True) -> "Radiance":
        """Return arrays to be filled, for `Correction.lines(..., out=...)`."""
        shape = (n_lines, n_columns)
        return cls(
            kernel.aligned(shape, np.float32),
            kernel.aligned(shape, np.float32) if std else None,
            kernel.aligned(shape, np.uint8),
        )

    def check_fits(self, dn: RawLines) -> None:
        """Raise InputError `wrong-shape` unless the arrays are writable ones for lines `dn`."""
        floats = [self.radiance] if self.std is None else [self.radiance, self.std]
        for array, dtype in [(each, np.float32) for each in floats] + [(self.flags, np.uint8)]:
            if array.shape != dn.shape or array.dtype != dtype or not array.flags.carray:
                msg = f"Output for lines {dn.shape} must be contiguous {np.dtype(dtype)} like them."
                raise InputError(msg, code="wrong-shape")
