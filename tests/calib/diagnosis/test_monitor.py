"""The monitor as a witness: what it sees of effects, and how well its readings are known."""

from dataclasses import replace

import numpy as np
from numpy.random import default_rng

from calib.diagnosis.recorded.conditions_table import ConditionsTable, conditions_table
from calib.diagnosis.recorded.monitor import LEAST_STD, UNKNOWN_STD, light_change, readings_of
from calib.forward.departure import Departure
from calib.forward.effects.gain_drift import GainDrift
from calib.forward.effects.lamp_drift import LampDrift
from calib.forward.effects.lamp_flicker import LampFlicker
from calib.forward.effects.stray_light import StrayLight
from calib.recording.header import Block, CameraHeader, RecordingHeader

CAMERA = CameraHeader(columns=8, bit_depth=12, line_period_us=1000.0)
STD = 5e-4


def table(n: int, read: float = 1.0, *, drift: float = 0.0) -> ConditionsTable:
    """Return `n` flats at two levels in turn, and a dark, the monitor read with chance in it."""
    rng = default_rng()
    blocks = [
        Block(
            block=str(k), kind="flat", exposure_us=500.0, level=1.0 + k % 2, lines=100,
            started_s=2.0 * k, radiance=1.0 + k % 2,
            monitor=read * (1.0 + k % 2) * float(np.exp(drift * k + STD * rng.standard_normal())),
        )
        for k in range(n)
    ]  # fmt: skip
    blocks.append(Block(block="d", kind="dark", exposure_us=500.0, lines=100, monitor=0.5))
    header = RecordingHeader(camera=CAMERA, blocks=tuple(blocks))
    return conditions_table(header, [100] * len(blocks))


def test_readings_are_white_about_their_level_whatever_their_unit() -> None:
    z = np.concatenate([
        found.whitened(found.observed)[:20] * found.std / STD * np.sqrt(20 / 18)
        for found in (readings_of(table(20, read)) for read in np.geomspace(1e-9, 1.0, 30))
    ])  # fmt: skip
    assert abs(z.mean()) < 1e-9
    assert abs(z.std() - 1.0) < 5.0 / np.sqrt(2 * len(z))


def test_their_scatter_is_told_by_themselves_and_no_drift_is_taken_for_it() -> None:
    for drift in (0.0, 0.01):
        found = np.mean([readings_of(table(40, drift=drift)).std ** 2 for _ in range(30)])
        # Second differences overlap: about 3 times the variance of independent ones.
        slack = 5.0 * np.sqrt(2.0 * 3.0 / (36 * 30))
        assert abs(found / (STD**2 + LEAST_STD**2) - 1.0) < slack
    assert readings_of(table(6)).std == UNKNOWN_STD


def test_it_sees_what_the_lamps_do_and_nothing_else() -> None:
    seen, flats = table(10), slice(0, 10)
    drifts: tuple[Departure, ...] = (LampDrift(0.1, 20.0),)
    change = light_change(drifts, seen)
    middle = seen.started_s[flats] + 0.05
    expected = np.log1p(0.1 * -np.expm1(-middle / 20.0))
    # It is read at both ends of a block of 0.1 s.
    assert np.abs(change[flats] - expected).max() < 1e-6
    assert change[10] == 0.0
    for other in (GainDrift(0.1, 20.0), StrayLight(0.5), LampFlicker(0.1)):
        assert not light_change((other,), seen).any()


def test_blocks_without_a_reading_do_not_count() -> None:
    seen = table(10)
    blind = tuple(b.model_copy(update={"monitor": None}) for b in seen.blocks)
    found = readings_of(replace(seen, blocks=blind))
    assert not found.whitened(np.arange(11.0)).any()
