"""When each block of a simulated recording is taken, and what the lamps do meanwhile."""

from collections.abc import Sequence
from dataclasses import dataclass

from calib.errors import InputError
from calib.forward.effects.illumination import Illumination
from calib.forward.lamp_clock import LampClock
from calib.forward.model import Model
from calib.recording.header import Block

AMBIENT_C = 25.0
"""The sensor's temperature where a block does not tell."""


@dataclass(frozen=True)
class ScheduledBlock:
    """A block whose unknowns are filled in, with the lamps as they burn during it."""

    block: Block
    started_s: float
    n_lines: int
    lamps: LampClock


def line_period_us(model: Model) -> float:
    """Return the camera's line period; InputError where the model does not tell."""
    if model.camera.line_period_us is None:
        raise InputError(
            "model: camera.line_period_us is missing; give it to simulate a recording.",
            code="line-period-missing",
        )
    return model.camera.line_period_us


def schedule(
    model: Model, blocks: Sequence[Block], *, frame_lines: int, settle_s: float
) -> tuple[ScheduledBlock, ...]:
    """Return `blocks` with started_s, temperature, lines and radiance where they were None.

    Lamps are switched as soon as the block before has ended. A dark caps the lens and leaves them
    burning. A block without started_s follows at once, or `settle_s` after a switch.

    Raises:
        InputError: A block starts before the one before it has ended, its exposure is longer than
            the line period, or its level is none that the lamps can have.
    """
    illumination = model.effect("illumination")
    known = isinstance(illumination, Illumination)
    lamps = LampClock.cold(illumination if isinstance(illumination, Illumination) else _none())
    period_us, free_s, scheduled = line_period_us(model), 0.0, []
    for block in blocks:
        _check_exposure(block, period_us)
        switched = lamps
        if block.kind != "dark":
            switched = lamps.switch(_emissions(block, model, len(lamps.target)), free_s)
        pause_s = settle_s if switched is not lamps else 0.0
        started_s = free_s + pause_s if block.started_s is None else block.started_s
        if started_s < free_s - 1e-6:
            raise InputError(
                f"block {block.block}: it starts at {started_s} s, before the one before it ends "
                f"at {free_s:.6f} s; give the blocks in the order of time.",
                code="blocks-out-of-order",
            )
        lamps = switched
        n_lines = block.lines or frame_lines
        filled = _filled(block, started_s, n_lines, lamps if known else None)
        scheduled.append(ScheduledBlock(filled, started_s, n_lines, lamps))
        free_s = started_s + n_lines * period_us * 1e-6
    return tuple(scheduled)


def _none() -> Illumination:
    return Illumination(radiance=())


def _check_exposure(block: Block, period_us: float) -> None:
    if block.exposure_us > period_us:
        raise InputError(
            f"block {block.block}: exposure_us is {block.exposure_us}, longer than the line period "
            f"of {period_us} us; shorten it.",
            code="exposure-too-long",
        )


def _emissions(block: Block, model: Model, n_lamps: int) -> tuple[float, ...]:
    """Return what each lamp is sent to at the block's level."""
    if model.source.kind == "led":
        return (block.level,) + (0.0,) * (n_lamps - 1)
    if block.level != int(block.level) or block.level > n_lamps:
        raise InputError(
            f"block {block.block}: level is {block.level:g}; give a whole number of lamps, 0 to "
            f"{n_lamps}.",
            code="bad-level",
        )
    return tuple(1.0 if lamp < block.level else 0.0 for lamp in range(n_lamps))


def _filled(block: Block, started_s: float, n_lines: int, lamps: LampClock | None) -> Block:
    nominal = block.radiance
    if nominal is None and lamps is not None and block.kind != "scene":
        capped = block.kind == "dark"
        nominal = 0.0 if capped else lamps.illumination.total(lamps.target)
    temperature_c = block.sensor_temperature_c
    return block.model_copy(
        update={
            "started_s": round(started_s, 6),
            "lines": n_lines,
            "radiance": nominal,
            "sensor_temperature_c": AMBIENT_C if temperature_c is None else temperature_c,
        }
    )
