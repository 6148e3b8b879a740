"""What a report draws: statistics as recorded, by the plain model, and by that with what was found.

Every array is in the units of the statistic, not whitened, and means are free of what each pixel's
own offset and slope absorb, in all three alike.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.diagnose import Examination
from calib.diagnosis.evidence.standing_out import N_STEPS
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
        model, whitening = self.examined.model, self.examined.evidence.whitening
        before, after = (whitening.energies(each) for each in (model.first, model.residual))
        chance = self._chance()
        return {
            kind: (energy - chance.get(kind, 0.0), after[kind] - chance.get(kind, 0.0))
            for kind, energy in before.items()
        }

    def _chance(self) -> dict[str, float]:
        """Return what chance gives of a squared residual, by kind of statistic."""
        evidence, pooled = self.examined.evidence, self.examined.evidence.pooled
        found = {"mean": float(evidence.space.degrees_of_freedom)}
        for kind, where in pooled.places.items():
            found[kind] = float(np.isfinite(pooled.std[:, where]).sum())
        return found | {
            "onset": float(np.isfinite(evidence.onset_std).sum()),
            "rare": float(evidence.rare_space.n_seen),
            "steps": 2.0 * N_STEPS,
            "codes": float(evidence.code_counts.n_numbers),
        }
