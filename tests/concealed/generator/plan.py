"""Sweep plans: which blocks, in which order, at which times and temperatures."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from tests.concealed.generator.sensor import Sensor

ORDERS = ("in_order", "reversed", "random", "level_major")
DARKS = ("interleaved", "last", "first", "none")
TEMPERATURES = ("constant", "warm_up", "steps")
_FEWEST_SAMPLES = 4


@dataclass(frozen=True)
class BlockPlan:
    """One block; `radiance` is what the certificate says, `temperature_c` what is true.

    `image` is the light along the columns relative to `radiance`; none where it is uniform.
    """

    name: str
    kind: str
    exposure_us: float
    level: float
    radiance: float
    n_samples: int
    started_s: float = 0.0
    temperature_c: float = 25.0
    image: tuple[float, ...] = ()


@dataclass(frozen=True)
class Plan:
    """The blocks in their order; times count from the recording's start."""

    blocks: tuple[BlockPlan, ...]
    line_period_us: float
    source: str
    lamps: int
    radiance_unit: str
    monitor: bool
    order: str
    darks: str
    temperature: str

    @property
    def duration_s(self) -> float:
        """From the first block's start to the last one's end."""
        last = self.blocks[-1]
        return last.started_s + last.n_samples * self.line_period_us * 1e-6

    @property
    def flats(self) -> tuple[BlockPlan, ...]:
        """The lit blocks."""
        return tuple(block for block in self.blocks if block.kind == "flat")

    @property
    def dark_blocks(self) -> tuple[BlockPlan, ...]:
        """The capped ones."""
        return tuple(block for block in self.blocks if block.kind == "dark")


def draw_plan(sensor: Sensor, rng: Generator, *, most_pixels: int, order: str, darks: str) -> Plan:
    """Return a plan that `sensor` takes in at most `most_pixels` pixels, else at random."""
    levels, exposures = _grid(sensor, rng)
    repeats = int(rng.choice([1, 1, 2])) if len(levels) * len(exposures) <= 12 else 1
    lit = [(level, t) for level in levels for t in exposures] * repeats
    caps = _dark_exposures(exposures, darks, rng)
    n_samples = most_pixels // (sensor.rows * sensor.columns * (len(lit) + len(caps) + 1))
    n_samples = max(_FEWEST_SAMPLES, n_samples)
    temperature = str(rng.choice(TEMPERATURES, p=[0.35, 0.4, 0.25]))
    source = "sphere" if levels == [int(level) for level in levels] else "led"
    stretch = 10.0 ** rng.uniform(2.3, 3.6) / max(exposures)
    brightest = max(levels) * stretch * max(exposures) * sensor.electrons_per_radiance_us
    per_level = float(f"{sensor.ceiling_e * rng.uniform(0.6, 0.9) / brightest:.4g}")
    blocks = [
        BlockPlan("", "flat", _ticks(t * stretch), level, level * per_level, n_samples)
        for level, t in _ordered(lit, order, rng)
    ]
    blocks = _with_darks(blocks, [_ticks(t * stretch) for t in caps], n_samples, darks, rng)
    period = _ticks(max(block.exposure_us for block in blocks) * rng.uniform(1.05, 1.4) + 5.0)
    plan = Plan(
        tuple(blocks), period, source, int(max(levels)) if source == "sphere" else 1,
        str(rng.choice(["W m-2 sr-1", "W m-2 sr-1 um-1"])), bool(rng.random() < 0.5),
        order, darks, temperature,
    )  # fmt: skip
    return _timed(_with_scene(plan, sensor, rng), rng)


def _with_scene(plan: Plan, sensor: Sensor, rng: Generator) -> Plan:
    """Give some line sensors a last block of light with edges, in the place of nothing."""
    if sensor.area or rng.random() > 0.3:
        return plan
    width = sensor.columns // int(rng.integers(4, 9))  # shifted: no edge where a register ends
    bars = ((np.arange(sensor.columns) + width // 3) // width) % 2
    image = np.where(bars == 0, 1.0, round(rng.uniform(0.1, 0.4), 2))
    brightest = max(plan.flats, key=lambda block: block.radiance * block.exposure_us)
    scene = replace(brightest, kind="scene", image=tuple(image.tolist()))
    return replace(plan, blocks=(*plan.blocks, scene))


def _grid(sensor: Sensor, rng: Generator) -> tuple[list[float], list[float]]:
    """Return levels and exposures (in units that are stretched later), both ascending."""
    n_exposures = int(rng.integers(3, 6))
    exposures = list(np.geomspace(1.0, rng.uniform(5.0, 12.0), n_exposures))
    if rng.random() < 0.5:
        exposures = list(np.linspace(1.0, rng.uniform(5.0, 10.0), n_exposures))
    kind = rng.random()
    if sensor.area and kind < 0.25:
        return [1.0], list(np.linspace(0.5, 10.0, 10))
    if kind < 0.65:
        lamps = int(rng.integers(3, 7))
        return [float(n) for n in range(1, lamps + 1)][-4:], exposures
    return [float(level) for level in np.round(np.linspace(0.25, 1.0, 4), 3)], exposures


def _ticks(exposure_us: float) -> float:
    """Return the nearest exposure of a clock of 10 MHz, at least a microsecond."""
    return max(1.0, round(exposure_us, 1))


def _dark_exposures(exposures: Sequence[float], darks: str, rng: Generator) -> list[float]:
    if darks == "none":
        return []
    n = int(rng.integers(2, 5))
    return [exposures[k] for k in np.linspace(0, len(exposures) - 1, n).round().astype(int)]


def _ordered(lit: list[Any], order: str, rng: Generator) -> list[Any]:
    if order == "random":
        return [lit[k] for k in rng.permutation(len(lit))]
    key = (lambda p: (p[0], p[1])) if order == "level_major" else (lambda p: (p[1], p[0]))
    return sorted(lit, key=key, reverse=order == "reversed")


def _with_darks(
    blocks: list[BlockPlan], caps: list[float], n_samples: int, darks: str, rng: Generator
) -> list[BlockPlan]:
    dark = [BlockPlan("", "dark", t, 0.0, 0.0, n_samples) for t in caps]
    if darks == "first":
        return dark + blocks
    if darks != "interleaved":
        return blocks + dark
    places = np.linspace(0, len(blocks), len(dark)).round().astype(int)
    mixed = list(blocks)
    for place, k in zip(places[::-1], rng.permutation(len(dark)), strict=True):
        mixed.insert(int(place), dark[k])
    return mixed


def _timed(plan: Plan, rng: Generator) -> Plan:
    """Give each block its name, start and temperature."""
    pause_s, start = rng.uniform(0.5, 12.0), 0.0
    starts = []
    for block in plan.blocks:
        starts.append(start)
        taken = block.n_samples * plan.line_period_us * 1e-6
        start = round(start + taken + pause_s * rng.uniform(0.7, 1.6), 3)
    temperatures = _temperatures(np.array(starts) / start, plan.temperature, rng)
    blocks = tuple(
        replace(block, name=f"{k:03d}", started_s=at, temperature_c=float(temperature))
        for k, (block, at, temperature) in enumerate(
            zip(plan.blocks, starts, temperatures, strict=True)
        )
    )
    return replace(plan, blocks=blocks)


def _temperatures(share: NDArray[np.float64], course: str, rng: Generator) -> NDArray[np.float64]:
    first, rise = rng.uniform(15.0, 35.0), rng.uniform(3.0, 14.0)
    wander = 0.1 * rng.standard_normal(len(share))
    if course == "warm_up":
        return np.asarray(first + rise * -np.expm1(-share / rng.uniform(0.2, 0.8)) + wander)
    if course == "steps":
        return np.asarray(first + rise * rng.permutation(np.arange(len(share)) % 3) / 2 + wander)
    return np.asarray(first + wander)
