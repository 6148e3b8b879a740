"""From a plan to codes: photons are counted, charge is moved, volts become codes."""

import copy
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from tests.concealed.generator.catalogue import ALL
from tests.concealed.generator.mechanism import Mechanism, Pixels, Stage
from tests.concealed.generator.plan import BlockPlan, Plan
from tests.concealed.generator.scan import Memory, Scan, column
from tests.concealed.generator.sensor import Sensor

_RANK = {name: rank for rank, name in enumerate(ALL)}


@dataclass(frozen=True)
class TakenBlock:
    """A block's codes, (n_samples, n_rows, n_columns), and its mean radiance at the source."""

    plan: BlockPlan
    codes: NDArray[np.integer]
    source_radiance: float


def take(
    sensor: Sensor, plan: Plan, mechanisms: Sequence[Mechanism], rng: Generator
) -> Iterator[TakenBlock]:
    """Yield the plan's blocks in their order; mechanisms remember from block to block."""
    chain = Chain(mechanisms, {}, rng)
    for scan in scans(sensor, plan):
        yield chain.block(scan)


def scans(sensor: Sensor, plan: Plan) -> Iterator[Scan]:
    """Yield each block with what all have in common."""
    temperature = float(np.mean([block.temperature_c for block in plan.blocks]))
    first = 0
    for block in plan.blocks:
        yield Scan(
            sensor, block, plan.line_period_us, plan.duration_s, first,
            max(one.radiance for one in plan.blocks),
            max(one.exposure_us for one in plan.blocks), temperature,
        )  # fmt: skip
        first += block.n_samples


class Chain:
    """The mechanisms of one recording in their order, and what they remember."""

    def __init__(self, mechanisms: Sequence[Mechanism], memory: Memory, rng: Generator) -> None:
        self._mechanisms = sorted(mechanisms, key=lambda one: (one.stage, _RANK[one.name]))
        self._memory = memory
        self._rng = rng

    def aside(self, rng: Generator) -> "Chain":
        """Return a chain that remembers the same and leaves this one as it is."""
        return Chain(self._mechanisms, copy.deepcopy(self._memory), rng)

    def block(self, scan: Scan) -> TakenBlock:
        """Take one block."""
        electrons, source_radiance = self.electrons(scan)
        dn = self.volts(electrons, scan)
        return TakenBlock(scan.block, self._codes(dn, scan), source_radiance)

    def electrons(self, scan: Scan) -> tuple[Pixels, float]:
        """Return the charge that reaches the output, and the source's mean radiance."""
        radiance = np.full((scan.n_samples, 1, 1), scan.block.radiance if scan.lit else 0.0)
        radiance = self._at(Stage.LAMP, radiance, scan)
        source_radiance = float(radiance.mean())
        if scan.block.image:
            radiance = radiance * np.array(scan.block.image)
        radiance = self._at(Stage.AMBIENT, radiance, scan)
        exposure_us = column(np.full(scan.n_samples, scan.block.exposure_us))
        exposure_us = self._at(Stage.EXPOSURE, exposure_us, scan)
        self._memory["exposure_us"] = exposure_us
        response = scan.sensor.electrons_per_radiance_us * scan.sensor.relative_response
        expected = self._at(Stage.PHOTONS, radiance * response * exposure_us, scan)
        expected = self._at(Stage.THERMAL, expected, scan)
        counted = self._collected(np.broadcast_to(expected, scan.shape), scan)
        counted = self._at(Stage.WELL, counted, scan)
        counted = np.minimum(counted, int(scan.sensor.full_well_e))
        return self._at(Stage.TRANSFER, counted, scan), source_radiance

    def _collected(self, expected: Pixels, scan: Scan) -> Pixels:
        if any(one.stage is Stage.COLLECTION for one in self._mechanisms):
            return self._at(Stage.COLLECTION, expected, scan)
        return self._rng.poisson(expected)

    def volts(self, electrons: Pixels, scan: Scan) -> Pixels:
        """Return what the converter sees, its own errors included, DN."""
        volts = self._at(Stage.COUPLING, electrons.astype(np.float64), scan)
        noise = scan.sensor.read_noise_e * self._rng.standard_normal(scan.shape)
        volts = volts + self._at(Stage.NOISE, noise, scan)
        dn = self._at(Stage.VOLTS, scan.sensor.gain_dn_per_e * volts, scan)
        dn = self._at(Stage.OFFSET, dn + scan.sensor.offset_dn, scan)
        return self._at(Stage.CONVERSION, dn, scan)

    def _codes(self, dn: Pixels, scan: Scan) -> NDArray[np.integer]:
        if any(one.stage is Stage.QUANTISATION for one in self._mechanisms):
            codes = self._at(Stage.QUANTISATION, dn, scan)
        else:
            codes = np.rint(dn).astype(np.int64)
        codes = np.clip(codes, 0, scan.sensor.top_code)
        codes = np.clip(self._at(Stage.CODES, codes, scan), 0, scan.sensor.top_code)
        sent = self._at(Stage.TRANSPORT, codes, scan)
        return sent.astype(np.uint8 if scan.sensor.bit_depth == 8 else np.uint16)

    def _at(self, stage: Stage, signal: Pixels, scan: Scan) -> Pixels:
        for one in self._mechanisms:
            if one.stage is stage:
                signal = one.act(signal, scan, self._memory, self._rng)
        return signal
