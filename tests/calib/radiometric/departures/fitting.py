"""Fits a departure's parameters to the recording that is calibrated, by plain least squares.

No search for what is missing: the departure is known, its parameters are not. Residuals in standard
errors: block means by column, darks against the intercepts, levels against the certificate, the
first lines of a block against its others, and, where asked for, covariances of neighbours.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from calib.forward.model import Model
from calib.forward.parameter import parameters_of
from calib.radiometric.departures.corrected_statistics import Settled, settle
from calib.radiometric.departures.expected_blocks import LitBlock
from calib.radiometric.estimation.choices import Choices
from calib.recording.block_statistics import RecordingStatistics
from calib.recording.statistics import column_statistics
from tests.calib.radiometric.departures.cases import Case
from tests.calib.radiometric.in_memory import InMemory

Floats = NDArray[np.float64]
FIRST_LINES = 2
DRAWN_LINES = 2048


@dataclass
class Fit:
    """A case and a recording of it."""

    case: Case
    recorded: InMemory

    def model(self) -> Model:
        """The model with the parameters that fit, started a fifth below the true ones."""
        told = parameters_of(type(self.case.effect))
        true = np.array(self.case.true_values)
        bounds = np.array([(told[n].low, told[n].high) for n in self.case.fitted]).T
        start = 0.8 * true
        found = least_squares(
            self._residuals, start, bounds=bounds, x_scale=np.abs(start), diff_step=1e-3,
            xtol=1e-4, ftol=1e-6,
        )  # fmt: skip
        return self.case.with_values(found.x)

    @cached_property
    def _statistics(self) -> RecordingStatistics:
        return column_statistics(self.recorded)

    @cached_property
    def _frames(self) -> list[Floats]:
        blocks = self.recorded.header.blocks
        return [np.concatenate([*self.recorded.frames(b.block)]).astype(float) for b in blocks]

    def _residuals(self, values: Floats) -> Floats:
        model = self.case.with_values(values)
        header = self.recorded.header
        settled = settle(self._statistics, header, model, Choices(), held_out_every=0)
        parts = [*self._means(settled), self._first_lines(settled)]
        if self.case.by_covariance:
            parts.append(self._covariances(settled))
        return np.nan_to_num(np.concatenate(parts))

    def _means(self, settled: Settled) -> Iterator[Floats]:
        estimate, scale = settled.parts.estimate, settled.parts.scale
        yield (estimate.fit.residual_dn * np.sqrt(estimate.fit.weights)).ravel()
        yield scale.level_ratio / scale.level_ratio_seen_std
        for s, shift in zip(self._statistics.fit, settled.shift_dn, strict=True):
            if s.block.kind == "dark":
                dark = estimate.fit.offset + estimate.current.dn_per_us * s.block.exposure_us
                variance = s.variance_dn2 / s.n_lines + estimate.fit.lines.offset_variance
                yield (s.mean_dn - shift - dark) / np.sqrt(variance)

    def _first_lines(self, settled: Settled) -> Floats:
        rows, left = [], None
        for lit, frames, s in zip(settled.lit, self._frames, self._statistics.fit, strict=True):
            at = lit.recorded.at(left, 0, len(frames))
            expected, left = lit.chain.expected(lit.light, at)
            off = (frames - expected).mean(axis=1)
            error = np.sqrt(s.variance_dn2.mean() / frames.shape[1])
            rows.append((off[:FIRST_LINES] - off[FIRST_LINES:].mean()) / error)
        return np.concatenate(rows)

    def _covariances(self, settled: Settled) -> Floats:
        """Of columns 0 and 1, 2 and 3 ... pooled, and of 1 and 2, 3 and 4 ..., by block."""
        rows = []
        for lit, frames, s in zip(settled.lit, self._frames, self._statistics.fit, strict=True):
            if s.block.kind == "flat":
                error = s.variance_dn2.mean() / np.sqrt(frames.size / 2)
                rows.append((_neighbours(frames) - self._expected_neighbours(lit)) / error)
        return np.concatenate(rows)

    def _expected_neighbours(self, lit: LitBlock) -> Floats:
        at = lit.recorded.at(None, 0, DRAWN_LINES)
        plain = replace(lit.chain, departures=())
        seen, without = (_neighbours(c.drawn(lit.light, at, [1])) for c in (lit.chain, plain))
        return seen - without


def _neighbours(lines: Floats) -> Floats:
    about = lines - lines.mean(axis=0)
    products = about[:, :-1] * about[:, 1:]
    scale = len(lines) / (len(lines) - 1)
    return scale * np.array([products[:, 0::2].mean(), products[:, 1::2].mean()])
