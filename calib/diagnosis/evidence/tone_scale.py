"""Squared amplitudes of tones on a scale on which they scatter by 1, weak or strong.

Power P over that of the noise, 1 + S of a tone of S, is half a noncentral chi-squared of two
degrees of freedom: it scatters by sqrt(1 + 2 S). On the scale whose slope is one over that,
sqrt(2 P - 1) from where P is 1, it scatters by 0.7 where there is no tone, and by 0.94 to 1.04 from
S of 1 on. What S / sqrt(1 + 2 S) has of a strong tone's deviance, 2 S, is a quarter;
sqrt(1 + 2 S) - 1 has all of it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.statistics.peak import Peak

Floats = NDArray[np.float64]

TONE_ERROR = 0.02
"""Of squared amplitudes: what is not quite a sine. How far a tone lies between two frequencies of
the spectrum is told by it (see `off_place`)."""


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

    @property
    def observed_dn2(self) -> Floats:
        """Return squared amplitudes that stand on the scale where those seen do on average.

        The scale is bent: its mean over powers that scatter by sqrt(1 + 2 S) about 1 + S lies
        1 / (2 sqrt(1 + 2 S)) below where 1 + S stands, to second order, and 0.13 where S is 0. In
        each of twenty blocks that would be half a standard deviation of a strength. What is added
        here is so much on average, within 0.06 for all S.
        """
        power = self._power(self.seen_dn2)
        below = np.minimum(power / 4.0, 0.5 / np.sqrt(np.maximum(2.0 * power - 1.0, 1.0)))
        root = _root(power) + below
        raised = np.where(root > 1.0, 0.5 * (root**2 + 1.0), root) - 1.0
        return np.asarray(raised * np.where(np.isfinite(self.noise_dn2), self.noise_dn2, 0.0))

    def whitened(self, squared_dn2: Floats, kept: NDArray[np.bool_] | None = None) -> Floats:
        """Return squared amplitudes, DN^2, less than 0 where noise hides them, as (n_tones,)."""
        return self._used((_root(self._power(squared_dn2)) - 1.0) / self._scatter, kept)

    def derivative(
        self, change_dn2: Floats, about_dn2: Floats, kept: NDArray[np.bool_] | None = None
    ) -> Floats:
        """Return the derivative of `whitened` where they move by `change_dn2` from `about_dn2`."""
        slope = 1.0 / np.sqrt(np.maximum(2.0 * self._power(about_dn2) - 1.0, 1.0))
        return self._used(slope * change_dn2 / self.noise_dn2 / self._scatter, kept)

    def _power(self, squared_dn2: Floats) -> Floats:
        """Return the power over the noise."""
        return np.maximum(1.0 + squared_dn2 / self.noise_dn2, 0.0)

    @cached_property
    def _scatter(self) -> Floats:
        """Return by how much they scatter: by 1, and by what is not quite a sine."""
        power = self._power(np.maximum(self.seen_dn2, 0.0))
        return np.hypot(
            1.0, TONE_ERROR * (power - 1.0) / np.sqrt(np.maximum(2.0 * power - 1.0, 1.0))
        )

    @staticmethod
    def _used(values: Floats, kept: NDArray[np.bool_] | None) -> Floats:
        return (values if kept is None else np.where(kept[:, None], values, 0.0)).ravel()


def _root(power: Floats) -> Floats:
    """Return powers over the noise on the scale, 1 where there is noise alone."""
    return np.where(power > 1.0, np.sqrt(np.maximum(2.0 * power - 1.0, 1.0)), power)
