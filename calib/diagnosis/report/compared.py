"""What a report draws: statistics as recorded, by the plain model, and by that with what was found.

Every array is in the units of the statistic, not whitened, and means are free of what each pixel's
own offset and slope absorb, in all three alike.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.diagnose import Examination
from calib.diagnosis.recorded.sensor import STRETCHES
from calib.diagnosis.statistics.counts import grouped

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Compared:
    """An examination's statistics before and after.

    Attributes:
        examined: The examination.
    """

    examined: Examination

    @property
    def found(self) -> bool:
        """Whether anything was found: else after is as before."""
        return self.examined.model.change is not None

    @cached_property
    def whitened_before(self) -> Floats:
        """Residuals of the means by the plain model, (n_blocks, n_pixels)."""
        return np.asarray(self.examined.model.first.means)

    @cached_property
    def whitened_after(self) -> Floats:
        """The same with what was found."""
        return np.asarray(self.examined.model.residual.means)

    def block_means(self, whitened: Floats) -> Floats:
        """Return the mean residual of each block, DN, (n_blocks,); NaN where no pixel counts."""
        weight = self.examined.evidence.space.weight
        total = (weight**2).sum(axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray((weight * whitened).sum(axis=1) / total)

    @cached_property
    def block_std(self) -> Floats:
        """Standard error of a block's mean residual, shared noise included, DN, (n_blocks,)."""
        evidence = self.examined.evidence
        common, lines = evidence.common, evidence.n * evidence.sensor.n_rows
        shared = common.fixed_dn2 + common.relative * evidence.signal_dn**2
        total = (evidence.space.weight**2).sum(axis=1)
        with np.errstate(divide="ignore"):
            return np.asarray(np.sqrt(1.0 / total + shared * common.memory / lines))

    def pooled(self, kind: str) -> tuple[Floats, Floats, Floats, Floats]:
        """Return a pooled statistic: recorded, plain, final, std, (n_blocks, n_groups) each."""
        evidence, model = self.examined.evidence, self.examined.model
        where = evidence.pooled.places[kind]
        plain = np.stack([mean.vector()[where] for mean, _ in evidence.pooled.expected])
        recorded = plain + model.observed.pooled[:, where]
        final = plain if model.change is None else plain + model.change.pooled[:, where]
        std = evidence.pooled.std[:, where]
        return recorded, plain, final, np.where(std > 0, std, np.inf)

    @cached_property
    def group_signal_dn(self) -> Floats:
        """Mean signal of each group of pixels, (n_blocks, n_groups)."""
        evidence = self.examined.evidence
        base, some = evidence.baseline, np.maximum(evidence.counts.pixels, 1.0)
        signal = (m - base.offset_dn for m in base.mean_dn)
        return np.stack([grouped(each, evidence.sensor) / some for each in signal])

    @property
    def stretch_of_group(self) -> NDArray[np.intp]:
        """Which stretch of the columns each group is, (n_groups,)."""
        return np.arange(self.examined.evidence.sensor.n_groups) % STRETCHES

    def energies(self) -> dict[str, tuple[float, float]]:
        """Return by kind of statistic the squared residuals before and after, less chance's."""
        evidence, model = self.examined.evidence, self.examined.model
        first, last = model.first, model.residual
        freedom = float(evidence.space.degrees_of_freedom)
        found = {
            "mean": (
                evidence.space.product(first.means, first.means) - freedom,
                evidence.space.product(last.means, last.means) - freedom,
            )
        }
        shape = evidence.pooled.std.shape
        n = evidence.pooled.std.size
        both = [p.rest[:n].reshape(shape) for p in (first, last)]
        for kind, where in evidence.pooled.places.items():
            used = float(np.isfinite(evidence.pooled.std[:, where]).sum())
            energy = [float((each[:, where] ** 2).sum()) - used for each in both]
            found[kind] = (energy[0], energy[1])
        blocks = evidence.n_blocks
        ends = np.cumsum([0, 3 * blocks, 4 * blocks, 15, 9])
        for k, (kind, used) in enumerate(
            (("onset", 3.0 * (blocks - 1)), ("rare", 4.0 * blocks), ("pixels", 5.0), ("codes", 9.0))
        ):
            part = slice(n + ends[k], n + ends[k + 1])
            energy = [float((p.rest[part] ** 2).sum()) - used for p in (first, last)]
            found[kind] = (energy[0], energy[1])
        tones = slice(n + ends[-1], None)
        found["tones"] = (
            float((first.rest[tones] ** 2).sum()),
            float((last.rest[tones] ** 2).sum()),
        )
        return found
