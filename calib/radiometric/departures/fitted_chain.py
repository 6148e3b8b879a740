"""A model's departures around the response that a recording showed.

The chain is the forward model's own: its links, in its order, with the response of Eq. 1 in the
place of the model's, so that what a departure does is written once.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns, Lines
from calib.forward.chain import run_on
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure
from calib.forward.effect import Effect, Stage
from calib.forward.effects.catalogue import place_of
from calib.forward.effects.empirical import Empirical
from calib.forward.effects.offset import Offset
from calib.forward.effects.responsivity import Responsivity
from calib.forward.effects.system_gain import SystemGain
from calib.forward.effects.vignette import Vignette
from calib.forward.left import Left
from calib.forward.moments import Moments

SMOOTH_CODES = ("adc_inl",)
"""Of the departures of codes, those that a mean follows; others leave it, or cannot be undone."""
_SPLITS = ("lag", "persistence", "cti")
"""They draw how charge parts, and so move the mean: what else draws scatters about it."""


@dataclass(frozen=True)
class Response:
    """Eq. 1 of each column at one exposure, (n_columns,): DN = dark + slope x radiance x t.

    Attributes:
        slope: DN per radiance per us; finite and above 0 in every column.
        dark_dn: DN0 and the dark current's signal, DN; finite.
    """

    slope: Columns
    dark_dn: Columns

    @classmethod
    def filled(cls, slope: Columns, dark_dn: Columns) -> "Response":
        """Return a response whose unknown columns have what the others have in the middle.

        Their neighbours see them by way of charge that moves; nothing else depends on them.
        """
        usable = np.isfinite(slope) & (slope > 0) & np.isfinite(dark_dn)
        return cls(
            np.where(usable, slope, np.median(slope[usable])),
            np.where(usable, dark_dn, np.median(dark_dn[usable])),
        )


def carried(effects: Iterable[Effect]) -> tuple[Effect, ...]:
    """Return the departures among `effects` that a correction deals with, in physical order.

    Those that change single codes (`adc_dnl`, `stuck_bit`, `black_clip`) or lines of codes
    (`duplicated_lines`) are left as they are: no response undoes them. An empirical term is dealt
    with as if it were one.
    """
    departures = [e for e in effects if isinstance(e, Departure | Empirical)]
    kept = [e for e in departures if e.stage < Stage.CODES or e.name in SMOOTH_CODES]
    return tuple(sorted(kept, key=place_of))


def moves_mean(effect: Effect) -> bool:
    """Return whether `effect` changes the mean of lines, apart from a constant."""
    return not effect.stochastic or effect.name in _SPLITS


@dataclass(frozen=True)
class FittedChain:
    """Departures around a response.

    Attributes:
        departures: As `carried` returns them.
        vignette: The model's, before which some departures act and behind which others.
        gain: Turns electrons into DN.
        gain_db: As the camera is set.
        response: Of the columns at the exposure of the lines.
        noise: Shot and read noise, for `scatter`.
    """

    departures: tuple[Effect, ...]
    vignette: Vignette
    gain: SystemGain
    gain_db: float
    response: Response
    noise: tuple[Effect, ...] = ()

    def expected(self, light: Lines, at: Conditions) -> tuple[Lines, Left | None]:
        """Return the mean DN of lines, (n_lines, n_columns), and what they leave on average.

        Args:
            light: Radiance, (n_lines, n_columns), or anything that broadcasts to it.
            at: Their conditions, with the camera's gain; the black level 0, as it is in DN0.
        """
        links = self._links([_exact(e) for e in self.departures if moves_mean(e)])
        dn, left = run_on(links, self._lines(light, at), at, Moments(0, noise=0.0))
        return dn, None if left is None else replace(left, drawn=False)

    def drawn(self, light: Lines, at: Conditions, seed: Sequence[int]) -> Lines:
        """Return lines as `expected` does, with all noise; the same seed gives the same noise.

        Each link draws from a generator of its own, so that links that are there or not do not
        change what the others draw.
        """
        signal: Lines = self._lines(light, at)
        entered = Stage.SOURCE
        for link in self._links((*self.departures, *self.noise)):
            rng = Moments([*seed, crc32(link.name.encode())], noise=1.0)
            signal, _ = run_on((link,), signal, at, rng, entered=entered)
            entered, at = max(entered, link.stage), link.conditions_after(at)
        return signal

    @cached_property
    def _response(self) -> tuple[Effect, ...]:
        """Return the links that make the response: lens, electrons, system gain, offset."""
        sample = self.response.slope.shape
        shaded = self.vignette.profile(sample) * self.gain.pixels(sample, self.gain_db)
        electrons = self.response.slope / shaded
        mean = float(electrons.mean())
        prnu: Any = tuple((electrons / mean).tolist())
        dark: Any = tuple(self.response.dark_dn.tolist())
        return self.vignette, Responsivity(mean, prnu=prnu), self.gain, Offset(pattern_dn=dark)

    def _links(self, around: Sequence[Effect]) -> list[Effect]:
        """Return the chain in physical order, the response in it."""
        return sorted((*around, *self._response), key=place_of)

    def _lines(self, light: Lines, at: Conditions) -> NDArray[np.float64]:
        shape = (at.n_lines, len(self.response.slope))
        return np.array(np.broadcast_to(light, shape), np.float64)


def _exact(effect: Effect) -> Effect:
    """Return the effect splitting charge exactly, where that is one of its parameters."""
    known: Any = effect
    return replace(known, partition_noise=0.0) if hasattr(effect, "partition_noise") else effect
