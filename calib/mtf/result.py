"""What `darkflat mtf` writes: contract §6."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.mtf.estimate import TransferMap
from calib.mtf.figures_of_merit import PER_MM, Cut, at_nyquist, cuts, first_zero
from calib.mtf.measure import Measurement
from calib.radiometric.coefficients.transfer_reference import TransferReference
from calib.recording import content_addressed
from calib.transfer.estimate import Estimate

FORMAT = "darkflat pixel transfer function 1"


@dataclass(frozen=True, eq=False)
class TransferResult:
    """A measurement with its figures of merit; `id` names the content of its file.

    Attributes:
        measurement: What was found.
        unknown_keys: Keys of mtf.toml that darkflat does not know.
    """

    measurement: Measurement
    unknown_keys: tuple[str, ...] = ()

    @cached_property
    def values(self) -> TransferMap:
        """The transfer function on the file's axis."""
        axis = self.measurement.frequency_per_um
        return self.measurement.transfer.at(axis, axis)

    @cached_property
    def cuts(self) -> tuple[Cut, Cut]:
        """Along x and along y."""
        along_x, along_y = cuts(
            self.measurement.transfer, self.measurement.grating.max_frequency_per_um
        )
        return along_x, along_y

    @cached_property
    def first_zeros(self) -> tuple[Estimate, Estimate]:
        """Along x and along y, per mm."""
        x, y = (first_zero(cut) for cut in self.cuts)
        return x, y

    @cached_property
    def nyquist(self) -> dict[str, Estimate]:
        """|T| at Nyquist's frequency, by axis."""
        return at_nyquist(self.measurement.transfer, self.measurement.scan.pitch_um)

    @cached_property
    def mean_std(self) -> float:
        """Of the transfer function over where it is valid."""
        return float(self.values.std[self.values.valid].mean())

    @cached_property
    def psf(self) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
        """The PSF and its std, per µm²."""
        return self.measurement.transfer.psf(self.measurement.position_um)

    @cached_property
    def id(self) -> str:
        """SHA-256 over the file's content."""
        return content_addressed.content_id(self._arrays, self._metadata)

    def save(self, path: Path) -> None:
        """Write TF.h5, whole or not at all.

        Raises:
            InputError: `cannot-write`.
            DiskFullError: `disk-full`.
        """
        content_addressed.write(path, self._arrays, self._metadata)

    def reference(self) -> TransferReference:
        """Return what a coefficient set carries of it."""
        x, y = self.first_zeros
        found = self.nyquist
        return TransferReference(
            id=self.id,
            method=self.measurement.method,
            pitch_um=self.measurement.scan.pitch_um,
            first_zero_per_mm=(x.answer()["value"], y.answer()["value"]),
            mtf_at_nyquist=(found["x"].answer()["value"], found["y"].answer()["value"]),
            mtf_at_nyquist_std=(found["x"].answer()["std"], found["y"].answer()["std"]),
        )

    @cached_property
    def _arrays(self) -> dict[str, NDArray[Any]]:
        found, values = self.measurement, self.values
        stage, stage_std = found.fit.stage_um
        psf, psf_std = self.psf
        return {
            "frequency_per_mm": PER_MM * found.frequency_per_um,
            "transfer": np.where(values.valid, values.transfer, complex(np.nan, np.nan)),
            "transfer_std": np.where(values.valid, values.std, np.nan),
            "transfer_real_std": np.where(values.valid, values.real_std, np.nan),
            "transfer_imaginary_std": np.where(values.valid, values.imaginary_std, np.nan),
            "valid": values.valid,
            "psf": psf,
            "psf_std": psf_std,
            "position_um": found.position_um,
            "harmonic_frequency_per_mm": PER_MM * found.fit.detector_per_um,
            "harmonic_transfer": self._harmonic_transfer,
            "harmonic_covariance": found.fit.transfer_covariance,
            "stage_position": np.array(found.fit.state.sampling.frames),
            "stage_error_um": stage,
            "stage_error_std_um": stage_std,
        }

    @property
    def _harmonic_transfer(self) -> NDArray[np.complex128]:
        """The harmonics' transfers with the PSF's centroid at 0."""
        fit = self.measurement.fit
        moved = self.measurement.shift_um - fit.state.sampling.alignment.shift_um
        turn = np.exp(2j * np.pi * (fit.state.harmonics.frequency_per_um @ moved))
        return np.asarray(fit.transfer * turn)

    @property
    def _metadata(self) -> dict[str, Any]:
        found = self.measurement
        return {
            "format": FORMAT,
            "method": found.method,
            "support_pixels": found.support,
            "pitch_um": found.scan.pitch_um,
            "m": found.scan.m,
            "n": found.scan.n,
            "eta2": found.grating.eta2,
            "period_um": found.grating.period_um,
            "grating_shift_um": found.shift_um.tolist(),
        }
