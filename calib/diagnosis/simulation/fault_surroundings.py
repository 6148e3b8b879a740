"""What faults of codes act on: pixels' means and noise, and what is seen of them without faults.

A search asks of many faults about the same means: what these give without any is worked out once.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.simulation.fault_chances import are_touched
from calib.diagnosis.simulation.fault_moments import PixelCodes, PixelMoments
from calib.diagnosis.statistics.change import Change
from calib.forward.code_fault import CodeFault

Floats = NDArray[np.float64]

LEAST_DN2 = 0.1
"""Other effects leave a pixel at least so much variance."""


@dataclass(frozen=True)
class Surroundings:
    """What faults of codes act on.

    Attributes:
        evidence: The recording's.
        means: Of pixels before rounding and before any fault, DN, (n_blocks, n_rows, n_columns).
        variance: Of each with rounding, DN^2, likewise.
    """

    evidence: Evidence
    means: Floats
    variance: Floats

    @classmethod
    def beside(cls, others: Change, evidence: Evidence) -> "Surroundings":
        """Return those that `others` leave, which is what all else changes."""
        base = evidence.baseline
        means = base.mean_dn + others.means.reshape(base.mean_dn.shape)
        variance = np.stack([
            np.maximum(v + variance_of_pixels(row, evidence), LEAST_DN2)
            for v, row in zip(base.variance_dn2, others.pooled, strict=True)
        ])  # fmt: skip
        return cls(evidence, means, variance)

    @property
    def n_codes(self) -> int:
        """Codes run 0 .. n_codes - 1."""
        return self.evidence.sensor.camera.full_scale_dn + 1

    def touched_by(self, faults: Sequence[CodeFault], b: int) -> bool:
        """Return whether any code that the pixels of block `b` give is changed by any fault."""
        return are_touched(self.means[b], self.variance[b], faults, self.n_codes - 1)

    def moments(self, faults: Sequence[CodeFault], b: int) -> PixelMoments:
        """Return the moments of a block's pixels, flat, tap by tap: each has its own noise."""
        parts = [
            self._codes_of(b, tap).moments([fault for fault in faults if fault.acts_on(tap)])
            for tap in range(len(self._pixels))
        ]
        if len(parts) == 1:
            return parts[0]
        whole: dict[str, Floats] = {}
        for each in fields(PixelMoments):
            found = [getattr(part, each.name) for part in parts]
            whole[each.name] = np.zeros((self.evidence.sensor.n_pixels, *found[0].shape[1:]))
            for pixels, values in zip(self._pixels, found, strict=True):
                if values.any():
                    whole[each.name][pixels] = values
        return PixelMoments(**whole)

    def moments_without(self, b: int) -> PixelMoments:
        """Return the moments of a block's pixels without faults."""
        if b not in self._moments:
            self._moments[b] = self.moments((), b)
        return self._moments[b]

    def _codes_of(self, b: int, tap: int) -> PixelCodes:
        """Return what codes the pixels of a block's tap give."""
        if (b, tap) not in self._codes:
            each = (self.means[b], self.variance[b], self.evidence.sums[b].sigma_dn)
            means, variance, seen = (values.ravel()[self._pixels[tap]] for values in each)
            self._codes[b, tap] = PixelCodes.of(means, variance, seen, self.n_codes - 1)
        return self._codes[b, tap]

    @cached_property
    def _pixels(self) -> list[NDArray[np.intp]]:
        """Which pixels each tap reads, flat."""
        tap = self.evidence.sensor.tap.ravel()
        return [np.flatnonzero(tap == k) for k in range(self.evidence.sensor.n_taps)]

    @cached_property
    def _codes(self) -> dict[tuple[int, int], PixelCodes]:
        return {}

    @cached_property
    def _moments(self) -> dict[int, PixelMoments]:
        return {}


def variance_of_pixels(pooled: Floats, evidence: Evidence) -> Floats:
    """Return each pixel's change of variance, (n_rows, n_columns), of one block's statistics."""
    group = np.minimum(evidence.sensor.group, evidence.sensor.n_groups - 1)
    return np.asarray(pooled[evidence.pooled.places["variance"]][group])
