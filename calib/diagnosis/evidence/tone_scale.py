"""Squared amplitudes of tones on a scale on which they scatter by 1, weak or strong.

Power P over that of the noise, 1 + S of a tone of S, is half a noncentral chi-squared of two
degrees of freedom: it scatters by sqrt(1 + 2 S), and sqrt(2 P) by 1 where S is large, by 0.66
where there is no tone. What S / sqrt(1 + 2 S) has of a strong tone's deviance, 2 S, is a quarter;
sqrt(2 (1 + S)) has all of it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.statistics.peak import Peak

Floats = NDArray[np.float64]

TONE_ERROR = 0.08
"""Of squared amplitudes: a tone lies between two frequencies of the spectrum."""
LEAST_POWER = 0.5
"""Of a derivative: what noise alone has is 1 on average, and a tone does not take from it."""


@dataclass(frozen=True)
class ToneScale:
    """Where squared amplitudes at the peaks of the spectra are whitened.

    Attributes:
        seen_dn2: Those of the recording, (n_blocks, n_peaks).
        noise_dn2: By how much they scatter where there is no tone; infinite: not looked at.
    """

    seen_dn2: Floats
    noise_dn2: Floats

    @classmethod
    def of(cls, peaks: Sequence[Peak], n_blocks: int) -> "ToneScale":
        """Return the scale of a recording whose spectra have `peaks`."""
        seen = np.array([peak.squared_amplitude_dn2 for peak in peaks])
        noise = np.array([peak.std_dn2 for peak in peaks])
        return cls(seen.reshape(-1, n_blocks).T, noise.reshape(-1, n_blocks).T)

    def whitened(self, squared_dn2: Floats, kept: NDArray[np.bool_] | None = None) -> Floats:
        """Return squared amplitudes, DN^2, less than 0 where noise hides them, as (n_tones,)."""
        root = np.sqrt(2.0 * self._power(squared_dn2)) - np.sqrt(2.0)
        return self._used(root / self._scatter, kept)

    def derivative(
        self, change_dn2: Floats, about_dn2: Floats, kept: NDArray[np.bool_] | None = None
    ) -> Floats:
        """Return the derivative of `whitened` where they move by `change_dn2` from `about_dn2`."""
        slope = 1.0 / np.sqrt(2.0 * np.maximum(self._power(about_dn2), LEAST_POWER))
        return self._used(slope * change_dn2 / self.noise_dn2 / self._scatter, kept)

    def _power(self, squared_dn2: Floats) -> Floats:
        """Return the power over the noise."""
        return np.maximum(1.0 + squared_dn2 / self.noise_dn2, 0.0)

    @cached_property
    def _scatter(self) -> Floats:
        """Scatter by 1, and by what is lost between two frequencies."""
        power = self._power(np.maximum(self.seen_dn2, 0.0))
        return np.hypot(1.0, TONE_ERROR * (power - 1.0) / np.sqrt(2.0 * power))

    @staticmethod
    def _used(values: Floats, kept: NDArray[np.bool_] | None) -> Floats:
        return (values if kept is None else np.where(kept[:, None], values, 0.0)).ravel()
