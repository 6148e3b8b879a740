"""Lines without a set's departures: the light that makes the chain read what was read.

    L_0 = (DN − dark) / (slope·t),    L_k+1 = L_k + (DN − F(L_k)) / (slope·t)

F is the forward model's expectation with the set's departures around its response: all columns and
lines of a stretch together, what earlier lines left in the pixels in it. Departures change a signal
by a small share, by which each round makes the error smaller. Those of the source (stage `source`)
were the bench's, and are none of the scene's.

A sample whose error stays has no such light, and keeps L_0. Above what the chain can read it is as
good as saturated; below the dark level some departures have no meaning.
"""

from dataclasses import dataclass, replace
from datetime import datetime
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns, RawLines
from calib.forward.conditions import Conditions
from calib.forward.effect import Stage
from calib.forward.effects.read_noise import ReadNoise
from calib.forward.effects.shot_noise import ShotNoise
from calib.forward.left import Left
from calib.forward.remembering import Remembering
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.coefficients.departures import Departures
from calib.radiometric.correction.seen_at import SeenAt
from calib.radiometric.departures.fitted_chain import FittedChain, Response, moves_mean
from calib.recording.header import CameraHeader

ROUNDS = 60
SETTLED_DN = 1e-3
SHRINKS_BY, PATIENCE = 0.99, 3
"""An error that falls by less, in so many rounds one after the other, stays."""
UNREACHED_DN = 0.5
_SAMPLES_DRAWN = 1 << 16
_FEWEST_DRAWN = 16
_STEPS = 5

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Inverted:
    """Lines in light, each (n_lines, n_columns).

    Attributes:
        signal_dn: What the response alone would have read above the dark level, DN.
        unreached: True where no light makes the chain read as much.
    """

    signal_dn: Floats
    unreached: NDArray[np.bool_]


class Inversion:
    """Takes departures out of the successive lines of a block.

    It remembers what its lines leave in the pixels, for the next ones.

    Attributes:
        notes: What was not known of the lines, and what stands for it.
    """

    def __init__(
        self,
        coefficients: CoefficientSet,
        departures: Departures,
        exposure_us: float,
        seen: SeenAt,
        follows: "Inversion | None" = None,
    ) -> None:
        """Prepare for lines.

        Args:
            coefficients: The set.
            departures: Of the set.
            exposure_us: Of the lines.
            seen: Under what conditions the lines were taken.
            follows: Of the block before; None where the sensor is taken to have rested.
        """
        self._chain = _chain(coefficients, departures, exposure_us, seen.gain_db)
        self._per_light = self._chain.response.slope * exposure_us
        self._exposure_us, self._seen = exposure_us, seen
        self._highest = coefficients.domain.radiance[1]
        self._follows, self._n_before, self._started = follows, 0, False
        self._left: Left | None = None
        self.notes = seen.notes

    @classmethod
    def of(
        cls,
        coefficients: CoefficientSet,
        exposure_us: float,
        camera: CameraHeader,
        *,
        at: datetime | None,
        temperature_c: float | None,
        follows: "Inversion | None",
    ) -> "Inversion | None":
        """Return what takes the set's departures out of lines; None where it has none."""
        told = coefficients.departures
        if told is None:
            return None
        seen = SeenAt.of(coefficients, told, camera, at=at, temperature_c=temperature_c)
        return cls(coefficients, told, exposure_us, seen, follows)

    @property
    def left(self) -> Left | None:
        """What the lines until now leave in the pixels."""
        if not self._started and self._follows is not None:
            return self._follows.left
        return self._left

    def lines(self, dn: RawLines) -> Inverted:
        """Return the next lines in light."""
        at = self._at(self.left, self._n_before, len(dn))
        inverted, self._left = self._inverted(dn.astype(np.float64), at)
        self._started, self._n_before = True, self._n_before + len(dn)
        return inverted

    def noise_ratio(self, signal_dn: Floats) -> Floats:
        """Return the temporal variance of inverted lines over that of the response's own."""
        signal, found, without = self._variances
        seen, plain = (np.interp(signal_dn, signal, v) for v in (found, without))
        return np.asarray(seen / plain)

    def _at(self, before: Left | None, first: int, n_lines: int) -> Conditions:
        seen = self._seen
        lines = np.arange(first, first + n_lines, dtype=np.float64)
        return Conditions(
            exposure_us=self._exposure_us,
            line_period_us=seen.line_period_us,
            line_times_s=seen.time_s + lines * (seen.line_period_us * 1e-6),
            sensor_temperature_c=seen.temperature_c,
            gain_db=seen.gain_db,
            before=before,
        )

    def _inverted(self, dn: Floats, at: Conditions) -> tuple[Inverted, Left | None]:
        per_light, dark = self._per_light, self._chain.response.dark_dn
        start = light = (dn - dark) / per_light
        last, slow = np.full(dn.shape, np.inf), np.zeros(dn.shape, np.int8)
        stuck = np.zeros(dn.shape, np.bool_)
        for _ in range(ROUNDS):
            expected, left = self._chain.expected(light, at)
            error = dn - expected
            far = np.abs(error)
            slow = np.where((far > SETTLED_DN) & (far > SHRINKS_BY * last), slow + 1, 0)
            # One that has just got stuck goes back to L_0, which its neighbours have yet to see.
            if not ((far > SETTLED_DN) & ~stuck).any():
                break
            stuck |= slow == PATIENCE
            light, last = np.where(stuck, start, light + error / per_light), far
        return Inverted(light * per_light, (far > UNREACHED_DN) & (dn > dark)), left

    @cached_property
    def _variances(self) -> tuple[Columns, Columns, Columns]:
        """Return signals, ascending, and variances with and without departures, (_STEPS,) each.

        Uniform lines are drawn from the same random numbers with and without departures, the former
        inverted; pooled over columns. Rounding's 1/12 is in both.
        """
        n_columns = len(self._per_light)
        at = self._at(None, 0, max(_FEWEST_DRAWN, _SAMPLES_DRAWN // n_columns))
        plain = replace(self._chain, departures=())
        rows = []
        for share in np.linspace(0.0, 1.0, _STEPS):
            light = np.asarray(share * self._highest)
            drawn = np.asarray(self._chain.drawn(light, at, [0]), np.float64)
            inverted, _ = self._inverted(drawn, at)
            both = (inverted.signal_dn, plain.drawn(light, at, [0]))
            found, without = (v.var(axis=0, ddof=1).mean() + 1.0 / 12.0 for v in both)
            rows.append((np.median(light * self._per_light), found, without))
        signals, with_them, without_them = np.array(rows).T
        return signals, with_them, without_them


def _chain(
    coefficients: CoefficientSet, departures: Departures, exposure_us: float, gain_db: float
) -> FittedChain:
    slope = np.where(coefficients.valid, coefficients.slope, np.nan)
    of_camera = [d for d in departures.departures if d.stage > Stage.SOURCE]
    return FittedChain(
        tuple(of_camera),
        departures.vignette,
        departures.gain,
        gain_db,
        Response.filled(slope, coefficients.dark_level_dn(exposure_us)),
        (ShotNoise(), ReadNoise(coefficients.read_noise_e)),
    )


def remembers(coefficients: CoefficientSet) -> bool:
    """Return whether what the set takes out of lines depends on lines before them."""
    if coefficients.departures is None:
        return False
    known = coefficients.departures.departures
    return any(isinstance(d, Remembering) and moves_mean(d) for d in known)
