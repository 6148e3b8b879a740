"""Codes one by one, and against their neighbours: how rough a histogram is."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

MOST_CONTRAST = 30.0
"""In standard deviations: one code that is far off is not the roughness of all."""
SHARE_ERROR = 0.01
"""Of a single code's share, relative, where noise is low: it hangs on the means."""
STEEP = 1.5
"""Neighbouring codes that differ by more than this factor are not compared."""
ENOUGH = 50.0
"""Codes with fewer samples expected than this are not judged one by one."""


@dataclass(frozen=True)
class CodeContrasts:
    """Observed and expected samples by code, (n_codes,) each, of which the first are not judged."""

    observed: Floats
    expected: Floats
    first: int

    @cached_property
    def samples(self) -> float:
        """All samples."""
        return float(self.observed.sum())

    def over_std(self, share: Floats) -> Floats:
        """Return changes of the codes that are judged one by one, over their std, (n_judged,)."""
        judged = self._judged
        variance = 1.0 / self.expected[judged] + SHARE_ERROR**2
        return np.asarray(share[judged] * self.samples / self.expected[judged] / np.sqrt(variance))

    def roughness(self, shares: Floats) -> float:
        """Return the sum of squared contrasts of neighbouring codes beyond chance, over its std."""
        judged = self._judged
        n_judged = int(judged.sum())
        if n_judged < 8:
            return 0.0
        one, variance = self._contrasts(shares[0])
        other, _ = self._contrasts(shares[-1])
        most = MOST_CONTRAST * np.sqrt(variance)
        product = np.clip(one, -most, most) * np.clip(other, -most, most)
        found = float((product / variance).sum())
        if len(shares) == 1:
            # Counts alone give the one, with all that the expectation may err by the other.
            found -= float(np.clip(found, (self._counted[judged] / variance).sum(), n_judged))
        return found / float(np.sqrt(4.0 * n_judged))

    @cached_property
    def width_variance(self) -> float:
        """Variance of the codes' widths, as contrasts of neighbouring codes tell it."""
        judged = self._judged
        if judged.sum() < 8:
            return 0.0
        contrast, variance = self._contrasts((self.observed - self.expected) / self.samples)
        return max(
            float((np.minimum(contrast**2, MOST_CONTRAST**2 * variance) - variance).mean()) / 1.5,
            0.0,
        )

    @cached_property
    def _judged(self) -> NDArray[np.bool_]:
        enough = self.expected > ENOUGH
        judged = enough & np.roll(enough, 1) & np.roll(enough, -1)
        # On the flank of a peak the shape of the noise counts, not the width of codes.
        for way in (1, -1):
            ratio = self.expected / np.maximum(np.roll(self.expected, way), 1e-9)
            judged &= (ratio < STEEP) & (ratio > 1.0 / STEEP)
        judged[: self.first] = False
        return judged

    def _contrasts(self, share: Floats) -> tuple[Floats, Floats]:
        """Return each judged code against its neighbours, relative, and the variance by chance."""
        code = np.flatnonzero(self._judged)
        places = (code, code - 1, (code + 1) % len(share))
        one, below, above = (self._relative(share, place) for place in places)
        return one - 0.5 * (below + above), self._counted[code] + 1.5 * SHARE_ERROR**2

    def _relative(self, share: Floats, code: NDArray[np.intp]) -> Floats:
        """Return what shares change of the samples of some codes, (n,), relative."""
        return np.asarray(share[code] * self.samples / np.maximum(self.expected[code], 1e-9))

    @cached_property
    def _counted(self) -> Floats:
        """Variance of the codes' contrasts, relative, that counting gives, (n_codes,)."""
        inverse = 1.0 / np.maximum(self.expected, 1.0)
        return np.asarray(inverse + 0.25 * (np.roll(inverse, 1) + np.roll(inverse, -1)))
