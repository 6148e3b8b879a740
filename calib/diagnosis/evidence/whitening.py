"""All statistics of a recording in one vector in which noise has unit size."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline.code_counts import CodeCounts
from calib.diagnosis.evidence.mean_space import MeanSpace
from calib.diagnosis.evidence.point import Point
from calib.diagnosis.evidence.pooled_space import SHARED_KINDS, PooledSpace
from calib.diagnosis.evidence.rare_space import RareSpace
from calib.diagnosis.evidence.standing_out import N_STEPS, held_slopes, steps
from calib.diagnosis.evidence.tone_scale import ToneScale
from calib.diagnosis.recorded.monitor import MonitorReadings
from calib.diagnosis.statistics.change import Change

Floats = NDArray[np.float64]

SMALL = 0.1
"""Of a change, that is added where its derivative is taken."""


@dataclass(frozen=True)
class Whitening:
    """How changes are weighed, and where each kind of statistic stands among the rest.

    Attributes:
        n: Lines of each block, (n_blocks,).
        means: The space of the means.
        pooled: That of the pooled statistics.
        onset_std: Standard deviations of the first lines' means, DN, (n_blocks, ONSET_LINES).
        rare: Where rare events are counted.
        tones: Where squared amplitudes of tones are weighed.
        codes: What the histogram of codes is compared with; None where blocks are left out, and
            with it all that blocks have only together: pixels that stand out, and the monitor.
        monitor: What it read.
        kept: Blocks that count, (n_blocks,), where some are left out.
    """

    n: Floats
    means: MeanSpace
    pooled: PooledSpace
    onset_std: Floats
    rare: RareSpace
    tones: ToneScale
    codes: CodeCounts | None
    monitor: MonitorReadings
    kept: NDArray[np.bool_] | None

    @cached_property
    def places(self) -> dict[str, slice]:
        """Where each kind of statistic besides the means stands in a point's `rest`."""
        sizes = {
            "pooled": self.pooled.std.size,
            "onset": self.onset_std.size,
            "rare": self.rare.n_sums,
        }
        if self.codes is not None:
            sizes |= {"steps": 2 * N_STEPS, "codes": self.codes.n_numbers}
        sizes["tones"] = self.tones.seen_dn2.size
        if self.codes is not None:
            sizes["monitor"] = len(self.n)
        found, start = {}, 0
        for kind, size in sizes.items():
            found[kind] = slice(start, start + size)
            start += size
        return found

    def point(self, change: Change) -> Point:
        """Return a change in the whitened space, without what the baseline absorbs."""
        onset = change.onset / self.onset_std
        if self.kept is not None:
            onset = np.where(self.kept[:, None], onset, 0.0)
        rest = [self.pooled.whitened(change.pooled), onset.ravel()]
        rest.append(self.rare.whitened(change.rare, self.kept))
        if self.codes is not None:
            rest.append(steps(change.pixel_variance * np.sqrt((self.n - 1).sum() / 2.0)))
            rest.append(steps(change.pixel_misfit))
            rest.append(self.codes.whitened(change.codes))
        rest.append(self.tones.whitened(change.tones, self.kept))
        if self.codes is not None:
            rest.append(self.monitor.whitened(change.monitor))
        return Point(self.means.project(change.means), np.concatenate(rest))

    def without_shared(self, point: Point) -> Point:
        """Return a point without what it says of what a line's pixels share, beside its peaks."""
        rest = point.rest.copy()
        pooled = rest[self.places["pooled"]].reshape(self.pooled.std.shape)
        for kind in SHARED_KINDS:
            pooled[:, self.pooled.places[kind]] = 0.0
        return Point(point.means, rest)

    def derivatives(self, changes: Sequence[Change], about: Change) -> list[Point]:
        """Return the whitened derivatives of statistics that move by `changes` from `about` on."""
        first = self.point(about)
        return [self._derivative(change, about, first) for change in changes]

    def _derivative(self, change: Change, about: Change, first: Point) -> Point:
        """Return the derivative where `first` is the point of `about`."""
        after = self.point(about + change * SMALL)
        found = (after - first) * (1.0 / SMALL)
        if self.codes is not None:
            counts = np.maximum(np.abs(first.rest), np.abs(after.rest))
            self._hold_steps(found.rest, counts, change, about)
        # Counts and tones are whitened along curves, and changes may be far larger than what is
        # seen of them.
        found.rest[self.places["rare"]] = self.rare.derivative(change.rare, about.rare, self.kept)
        found.rest[self.places["tones"]] = self.tones.derivative(
            change.tones, about.tones, self.kept
        )
        return found

    def _hold_steps(self, slopes: Floats, counts: Floats, change: Change, about: Change) -> None:
        """Hold the slopes, (n_rest,), of pixels that stand out, where they are."""
        start = self.places["steps"].start
        pairs = (
            (change.pixel_variance, about.pixel_variance),
            (change.pixel_misfit, about.pixel_misfit),
        )
        for k, (moved, before) in enumerate(pairs):
            part = slice(start + k * N_STEPS, start + (k + 1) * N_STEPS)
            slopes[part] = held_slopes(slopes[part], counts[part], moved, before)

    def product(self, one: Point, other: Point) -> float:
        """Return the inner product."""
        return self.means.product(one.means, other.means) + float(one.rest @ other.rest)

    def energies(self, point: Point) -> dict[str, float]:
        """Return the squared length of a point in each kind of statistic, by its name."""
        found = {"mean": max(self.means.product(point.means, point.means), 0.0)}
        pooled = point.rest[self.places["pooled"]].reshape(self.pooled.std.shape)
        for kind, where in self.pooled.places.items():
            found[kind] = float((pooled[:, where] ** 2).sum())
        for kind, where in self.places.items():
            if kind != "pooled":
                found[kind] = float((point.rest[where] ** 2).sum())
        return found
