"""The spectral radiance of a source's lamps, as a certificate or a spectroradiometer states it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.errors import InputError
from calib.radiometric.spectral.spectral_table import (
    check_positive,
    read_table,
    sorted_by_wavelength,
)


@dataclass(frozen=True)
class LampSpectra:
    """Straight between their wavelengths, never extrapolated.

    Attributes:
        wavelength_nm: Increasing, (n,).
        radiance: Of each lamp alone in the source, W m-2 sr-1 nm-1, (n_lamps, n).
        radiance_std: Standard uncertainty of each lamp's own, the same sign at all wavelengths
            and independent between lamps, (n_lamps, n).
        certificate_relative_std: Standard uncertainty of the standard that all lamps and
            wavelengths trace to (type B, k = 1).
        names: The lamps' names, in the order in which levels light them.
    """

    wavelength_nm: Columns
    radiance: NDArray[np.float64]
    radiance_std: NDArray[np.float64]
    certificate_relative_std: float
    names: tuple[str, ...]

    @classmethod
    def load(cls, path: Path | str, *, certificate_relative_std: float) -> "LampSpectra":
        """Read a CSV file: wavelength_nm, one column per lamp, and optionally <lamp>_std.

        Raises:
            InputError: The file is missing or cannot be used; `certificate-std` where the
                certificate's uncertainty is not a share between 0 and 1.
        """
        if not 0 <= certificate_relative_std < 1:
            msg = (
                f"The certificate's relative standard uncertainty is {certificate_relative_std}; "
                "give a share from 0 to 1 (k = 1)."
            )
            raise InputError(msg, code="certificate-std")
        table = read_table(Path(path), ["wavelength_nm"], None)
        names = tuple(n for n in table.names if n != "wavelength_nm" and not n.endswith("_std"))
        orphans = [n for n in table.names if n.endswith("_std") and n[:-4] not in names]
        if not names or orphans:
            msg = f"{path} needs a column per lamp, and none like {', '.join(orphans) or '-'}."
            raise InputError(msg, code="missing-column")
        order = sorted_by_wavelength(table, wavelength_nm := table.numbers("wavelength_nm"))
        radiance = np.array([table.numbers(name) for name in names])
        std = np.array([table.numbers(f"{name}_std", empty=0.0) for name in names])
        for name, values, its_std in zip(names, radiance, std, strict=True):
            check_positive(table, name, values, zero=True)
            check_positive(table, f"{name}_std", its_std, zero=True)
        return cls(
            wavelength_nm[order],
            radiance[:, order],
            std[:, order],
            certificate_relative_std,
            names,
        )
