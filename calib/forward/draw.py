"""Draws lines: by the compiled kernel where the links allow it, else link by link."""

from numpy.random import Generator

from calib.arrays import Lines, RawLines
from calib.forward.chain import ExpectedElectrons, expected_electrons, run_on
from calib.forward.conditions import Conditions
from calib.forward.drawn import Drawn, as_codes
from calib.forward.effect import Effect, Stage
from calib.forward.fused import can_fuse, draw_fused
from calib.forward.left import Left


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
    if can_fuse(after):
        return Drawn(draw_fused(after, expected, at, rng), None, effects, scene, at, expected)
    dn, left = draw_link_by_link(after, expected, at, rng, bit_depth)
    return Drawn(dn, left, effects, scene, at, expected)


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
