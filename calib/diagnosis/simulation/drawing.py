"""Draws a few lines of each block, from the same noise with and without effects."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from calib.diagnosis.simulation.chain_run import FittedChain
from calib.diagnosis.simulation.drawn_lines import Drawn, drawn_of
from calib.diagnosis.simulation.opposite_tone import opposite_tone
from calib.diagnosis.simulation.sampled_lines import is_tone
from calib.diagnosis.simulation.stack import Stack
from calib.forward.effect import Effect
from calib.forward.left import Left

SAMPLES = 120_000
"""So many are drawn of the whole recording."""
FEWEST_LINES, MOST_LINES = 8, 16


@dataclass(frozen=True)
class Drawing:
    """Of the lines in the middle of each block, where a step before it has died away.

    Attributes:
        chain: The links.
    """

    chain: FittedChain

    @cached_property
    def n_lines(self) -> int:
        """Lines that are drawn of each block."""
        per_line = self.chain.sensor.n_pixels * len(self.chain.table.blocks)
        wanted = int(np.clip(SAMPLES // per_line, FEWEST_LINES, MOST_LINES))
        return max(2, min(wanted, int(self.chain.table.n_lines.min())))

    def of_both_signs(
        self, effects: Sequence[Effect], lefts: Sequence[Left | None], draw: int, *, coded: bool
    ) -> list[Drawn]:
        """Return lines with effects, where these have noise of their own also with the opposite.

        An effect's own noise has chance products with that of the baseline, of either sign. So has
        a tone, which without codes is worked out elsewhere.

        Args:
            effects: The effects.
            lefts: What each block finds in the pixels.
            draw: Number of the noise.
            coded: Whether lines are of whole codes.
        """
        in_lines = effects if coded else [e for e in effects if not is_tone(e)]
        signed = {1.0: in_lines}
        if any(map(self.chain.has_noise, in_lines)) or any(map(is_tone, in_lines)):
            signed[-1.0] = [opposite_tone(effect) for effect in in_lines]
        return [self._drawn(e, lefts, draw, coded=coded, sign=sign) for sign, e in signed.items()]

    def plain(self, draw: int, *, coded: bool) -> Drawn:
        """Return lines without effects, drawn once."""
        if (draw, coded) not in self._plain:
            nothing = (None,) * len(self.chain.table.blocks)
            self._plain[draw, coded] = self._drawn((), nothing, draw, coded=coded)
        return self._plain[draw, coded]

    def _drawn(
        self,
        effects: Sequence[Effect],
        lefts: Sequence[Left | None],
        draw: int,
        *,
        coded: bool,
        sign: float = 1.0,
    ) -> Drawn:
        chain, stack = self.chain, self._middle
        if any(left is not None for left in lefts):
            found = enumerate(zip(self._first, lefts, strict=True))
            stack = stack.before([chain.left_after(b, k, effects, x) for b, (k, x) in found])
        lines = chain.drawn(stack, effects, draw, coded=coded, sign=sign)
        return drawn_of(lines.reshape(-1, self.n_lines, *lines.shape[1:]), chain, coded=coded)

    @cached_property
    def _first(self) -> list[int]:
        """The first line that is drawn of each block."""
        return [(int(lines) - self.n_lines) // 2 for lines in self.chain.table.n_lines]

    @cached_property
    def _middle(self) -> Stack:
        drawn = np.arange(float(self.n_lines))
        lines = [(b, k + drawn) for b, k in enumerate(self._first)]
        return Stack.of(self.chain.table, lines, "drawn")

    @cached_property
    def _plain(self) -> dict[tuple[int, bool], Drawn]:
        return {}
