"""Blocks that the bench of a recording can take: at its conditions, and none that saturates."""

from dataclasses import dataclass, replace

import numpy as np

from calib.diagnosis.deciding.bench import Taken
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.recorded.conditions_table import ConditionsTable
from calib.recording.header import Block

MOST_OF_SCALE = 0.9
"""Of full scale, that the brightest pixel may reach."""


@dataclass(frozen=True)
class BenchBlocks:
    """What a block is made from.

    Attributes:
        table: The conditions of the recording at hand.
        lines: Of a block.
        exposures: Of flats and darks, us, from the shortest on.
        levels: Of flats, from the lowest on.
        radiance_per_level: On average.
        most_dose: That the brightest pixel stands, radiance us.
        reads_monitor: Whether flats come with a reading.
    """

    table: ConditionsTable
    lines: int
    exposures: tuple[float, ...]
    levels: tuple[float, ...]
    radiance_per_level: float
    most_dose: float
    reads_monitor: bool

    @classmethod
    def of(cls, evidence: Evidence, *, reads_monitor: bool) -> "BenchBlocks":
        """Return what a recording's own blocks tell."""
        table = evidence.table
        signal = float(np.quantile(evidence.baseline.slope, 0.995))
        room = MOST_OF_SCALE * evidence.sensor.camera.full_scale_dn
        dose = (room - float(np.median(evidence.baseline.offset_dn))) / max(signal, 1e-300)
        flat = np.array([b.kind != "scene" for b in table.blocks])
        lit = (table.level > 0) & flat
        return cls(
            table,
            int(np.median(table.n_lines)),
            tuple(sorted({float(t) for t in table.exposure_us[flat]})),
            tuple(sorted({float(level) for level in table.level[lit]})),
            float((table.radiance[lit] / table.level[lit]).mean()),
            dose,
            reads_monitor,
        )

    @property
    def recorded(self) -> set[tuple[float, float]]:
        """Levels and exposures, us, of the recording's blocks."""
        return set(zip(self.table.level, self.table.exposure_us, strict=True))

    def seen(self) -> list[Taken]:
        """Return each condition of the recording once, in its order."""
        found: dict[tuple[str, float, float], Taken] = {}
        burning = self.levels[0]
        for block in self.table.blocks:
            if block.kind == "flat":
                burning = block.level
                one = self.flat(block.exposure_us, block.level)
            elif block.kind == "dark":
                one = self.dark(block.exposure_us, burning)
            else:
                continue
            if one is not None:
                found.setdefault((block.kind, block.exposure_us, block.level), one)
        return list(found.values())

    def dark(self, exposure_us: float, burning: float | None = None) -> Taken:
        """Return a dark, taken while the lamps burn at a level: the highest where none is told."""
        level = self.levels[-1] if burning is None else burning
        return Taken(self._block("dark", exposure_us, 0.0), level)

    def flat(self, exposure_us: float, level: float) -> Taken | None:
        """Return a flat; None where it would saturate."""
        if level * self.radiance_per_level * exposure_us > self.most_dose:
            return None
        block = self._block("flat", exposure_us, level)
        return Taken(block.model_copy(update={"monitor": self._reading(level)}), level)

    def scene(self, exposure_us: float, level: float, more: int) -> Taken | None:
        """Return a bar with edges, of `more` times as many lines; None where it would saturate."""
        flat = self.flat(exposure_us, level)
        if flat is None:
            return None
        changed = {"kind": "scene", "scene": "bar", "monitor": None, "lines": self.lines * more}
        return replace(flat, block=flat.block.model_copy(update=changed))

    def _reading(self, level: float) -> float | None:
        """Return what the monitor is expected to read, in proportion to those of that level."""
        if not self.reads_monitor:
            return None
        known = [b.monitor for b in self.table.blocks if b.monitor and b.level == level]
        return float(np.mean(known)) if known else level

    def _block(self, kind: str, exposure_us: float, level: float) -> Block:
        known = [b.sensor_temperature_c for b in self.table.blocks]
        return Block.model_validate(
            {
                "block": "planned", "kind": kind, "exposure_us": float(exposure_us),
                "level": float(level), "lines": self.lines,
                "sensor_temperature_c": next((t for t in reversed(known) if t is not None), None),
            }
        )  # fmt: skip
