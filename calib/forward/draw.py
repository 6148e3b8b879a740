"""Draws lines: by the compiled kernel where the links allow it, else link by link."""

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines, RawLines
from calib.forward.chain import (
    ExpectedElectrons,
    conditions_after,
    expected_electrons,
    run_on,
)
from calib.forward.conditions import Conditions
from calib.forward.drawn import Drawn, as_codes
from calib.forward.effect import Effect, Stage
from calib.forward.fused import can_fuse, draw_fused
from calib.forward.left import Left, both


def draw(
    effects: tuple[Effect, ...], scene: Lines, at: Conditions, rng: Generator, bit_depth: int
) -> Drawn:
    """Return `at.n_lines` lines of `scene`, (1 or n_lines, *sample) of radiance.

    Both ways draw from the same distribution, but not the same numbers.
    """
    first_after_light = next(
        (k for k, e in enumerate(effects) if e.name == "shot_noise" or e.stage > Stage.CHARGE),
        len(effects),
    )
    before, after = effects[:first_after_light], effects[first_after_light:]
    expected = expected_electrons(before, scene, at, rng)
    seen = conditions_after(before, at)
    to_codes, of_codes = _split_behind_adc(after)
    left = None
    if can_fuse(to_codes):
        dn = draw_fused(to_codes, expected, seen, rng)
    else:
        dn, left = draw_link_by_link(to_codes, expected, seen, rng, bit_depth)
    if of_codes:
        codes, of_lines = run_on(of_codes, dn.astype(np.float64), seen, rng, entered=Stage.CODES)
        dn, left = as_codes(codes, bit_depth), both(left, of_lines)
    return Drawn(dn, left, effects, scene, at, expected)


def _split_behind_adc(links: tuple[Effect, ...]) -> tuple[tuple[Effect, ...], tuple[Effect, ...]]:
    """Return the links up to the converter, and those that work on its codes."""
    behind = [effect.name for effect in links].index("adc") + 1
    return links[:behind], links[behind:]


def draw_link_by_link(
    after: tuple[Effect, ...],
    expected: ExpectedElectrons,
    at: Conditions,
    rng: Generator,
    bit_depth: int,
) -> tuple[RawLines, Left | None]:
    """Apply each link after the light; return codes, (n_lines, *sample), and what they leave."""
    signal, left = run_on(after, expected.by_line(), at, rng, entered=Stage.CHARGE)
    return as_codes(signal, bit_depth), left
