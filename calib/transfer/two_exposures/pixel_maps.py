"""What two exposures tell of every pixel, and the file that it is kept in."""

import math
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from calib.kernels.in_parts import in_parts
from calib.kernels.pixel_sums import Pixels
from calib.recording import content_addressed
from calib.transfer.two_exposures.exposure_pair import ExposurePair
from calib.transfer.two_exposures.pixel_state import STATE_CODES, PixelState

Method = Literal["sanuc", "s3nuc"]
ROUNDING_DN2 = 1.0 / 12.0
"""Sheppard's correction: what rounding to whole codes adds to a variance."""
FORMAT = "darkflat two-exposure maps 1"


@dataclass(frozen=True)
class PixelMaps:
    """One value per pixel, (n_pixels,); every `_std` is a standard uncertainty (k = 1).

    Values that a pixel's `reason` does not allow are NaN, and so are their uncertainties. What is
    told may be negative: a read noise variance scatters about its value, and that may be small.

    Attributes:
        system_gain_dn_per_e: G.
        system_gain_dn_per_e_std: Its uncertainty.
        bias_dn: B, what the pixel reads at exposure 0.
        bias_dn_std: Its uncertainty.
        photoelectrons: K̄, of the first exposure; what dark current adds is among them.
        photoelectrons_std: Its uncertainty. The estimate is skewed; 1/K̄ is not (docs).
        photoelectrons_step: ΔK̄, by how many more the second exposure has.
        photoelectrons_step_std: Its uncertainty.
        read_noise_variance_dn2: σ_n², without the 1/12 DN² of rounding.
        read_noise_variance_dn2_std: Its uncertainty.
        gain_bias_covariance: Of G and B, DN²/e⁻.
        signal_dn: D/(r−1), what the first exposure's light adds to the bias.
        reason: `PixelState`, uint8.
    """

    system_gain_dn_per_e: Pixels
    system_gain_dn_per_e_std: Pixels
    bias_dn: Pixels
    bias_dn_std: Pixels
    photoelectrons: Pixels
    photoelectrons_std: Pixels
    photoelectrons_step: Pixels
    photoelectrons_step_std: Pixels
    read_noise_variance_dn2: Pixels
    read_noise_variance_dn2_std: Pixels
    gain_bias_covariance: Pixels
    signal_dn: Pixels
    reason: NDArray[np.uint8]

    @classmethod
    def empty(cls, n_pixels: int) -> "PixelMaps":
        """Return maps to be filled."""
        arrays: dict[str, Any] = {f.name: np.empty(n_pixels) for f in fields(cls)}
        return cls(**{**arrays, "reason": np.empty(n_pixels, np.uint8)})

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Which pixels are determined in everything, (n_pixels,)."""
        return np.equal(self.reason, PixelState.VALID)

    def counts(self) -> dict[str, int]:
        """Return how many pixels are in each state that occurs.

        >>> arrays = [np.zeros(3)] * 12
        >>> PixelMaps(*arrays, np.array([0, 5, 0], np.uint8)).counts()
        {'valid': 2, 'no_shot_noise': 1}
        """
        number = np.bincount(self.reason, minlength=len(PixelState))
        return {s.name.lower(): int(number[s]) for s in PixelState if number[s]}

    def save(self, path: Path | str, shape: tuple[int, ...], about: Mapping[str, Any]) -> str:
        """Write the maps (HDF5) as images of `shape`, whole or not at all; return their hash.

        Args:
            path: The file.
            shape: (n_rows, n_columns), or (n_columns,) for a line sensor.
            about: What else is told, ready for JSON.

        Raises:
            InputError: `cannot-write`; DiskFullError where there is no room.
        """
        arrays = {f.name: getattr(self, f.name).reshape(shape) for f in fields(self)}
        codes = {state.name.lower(): int(state) for state in PixelState}
        metadata = {**about, "format": FORMAT, "reason_codes": codes}
        return content_addressed.write(Path(path), arrays, _finite(metadata))


def by_pixel(pair: ExposurePair, fill_maps: Callable[..., None]) -> PixelMaps:
    """Return the maps that a compiled loop fills, some pixels at a time, on all cores.

    Args:
        pair: Both exposures.
        fill_maps: Takes `PairArrays`, `ROUNDING_DN2`, `STATE_CODES`, the maps in their order
            without the last, and that, the reason.
    """
    gain, maps = pair.ratio_of_sums, PixelMaps.empty(pair.n_pixels)
    *values, reason = (getattr(maps, field.name) for field in fields(PixelMaps))

    def fill(some: slice) -> None:
        part = tuple(each[some] for each in values)
        fill_maps(pair.arrays(gain, some), ROUNDING_DN2, STATE_CODES, part, reason[some])

    deque(in_parts(pair.n_pixels, fill), maxlen=0)
    return maps


def _finite(value: Any) -> Any:
    """Return `value` with None for every number that JSON does not know."""
    if isinstance(value, dict):
        return {key: _finite(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
