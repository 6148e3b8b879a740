"""A plan's steps, in the order of acquisition. Deterministic: the same plan, the same steps."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from calib.recording.header import Block, BlockKind, RecordingHeader
from service.plan.header import recording_header
from service.plan.model import Plan
from service.plan.step import Step
from service.plan.sweeps import Listed, Point


class _Taken(NamedTuple):
    """A block that has no name yet."""

    kind: BlockKind
    exposure_us: float
    burning: float
    lines: int
    wait_s: float = 0.0
    scene: str | None = None


def expand(plan: Plan) -> tuple[Step, ...]:
    """Return every step of `plan`; blocks are named "000", "001", … in the order of acquisition."""
    taken = [block for repeat in range(plan.repeats) for block in _one_repeat(plan, repeat)]
    width = max(3, len(str(len(taken) - 1)))
    return tuple(_step(plan, i, f"{i:0{width}d}", block) for i, block in enumerate(taken))


def blocks(plan: Plan) -> tuple[Block, ...]:
    """Return the blocks that a simulation of `plan` draws."""
    return tuple(step.block for step in expand(plan))


def planned_header(plan: Plan, *, columns: int) -> RecordingHeader:
    """Return the header of a recording of `plan`, all blocks as planned."""
    return recording_header(plan, columns=columns, blocks=blocks(plan))


def _one_repeat(plan: Plan, repeat: int) -> Iterator[_Taken]:
    if isinstance(plan.sweep, Listed):
        for b in plan.sweep.blocks:
            lines = b.lines or plan.lines
            yield _Taken(b.kind, b.exposure_us, b.level, lines, b.wait_s, b.scene)
        return
    flats = plan.order.arranged(tuple(plan.sweep.points()), repeat)
    darks = _dark_exposures(flats, plan.darks.per_exposure)
    before = _darks_before(plan, len(darks), len(flats))
    for position in range(len(flats) + 1):
        # A dark changes no lamp: what burned before it, or will after it, burns behind the cap.
        burning = flats[min(position, len(flats) - 1)].level
        for exposure_us, place in zip(darks, before, strict=True):
            if place == position:
                yield _Taken("dark", exposure_us, burning, plan.lines)
        if position < len(flats):
            yield _Taken("flat", *flats[position], plan.lines)


def _dark_exposures(flats: Sequence[Point], per_exposure: int) -> list[float]:
    """Return the exposure of each dark, in the order in which the flats first use them."""
    exposures_us = dict.fromkeys(point.exposure_us for point in flats)
    return [exposure_us for exposure_us in exposures_us for _ in range(per_exposure)]


def _darks_before(plan: Plan, n_darks: int, n_flats: int) -> list[int]:
    """Return, per dark, before which flat it is taken; `n_flats` is after the last, -1 never."""
    match plan.darks.placement:
        case "interleaved":
            return [i * n_flats // n_darks for i in range(n_darks)]
        case "before":
            return [0] * n_darks
        case "after":
            return [n_flats] * n_darks
        case "none":
            return [-1] * n_darks


def _step(plan: Plan, index: int, name: str, taken: _Taken) -> Step:
    is_dark = taken.kind == "dark"
    level = 0.0 if is_dark else taken.burning
    block = Block(
        block=name,
        kind=taken.kind,
        exposure_us=taken.exposure_us,
        level=level,
        lines=taken.lines,
        radiance=0.0 if is_dark else plan.source.radiance.get(level),
        scene=taken.scene,
    )
    return Step(
        index=index,
        block=block,
        burning=taken.burning,
        lines=taken.lines,
        wait_s=taken.wait_s,
        off_afterwards=plan.lamps.mode_at(taken.burning) == "off_between_blocks",
    )
