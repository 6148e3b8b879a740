"""The plans that are looked through: few, plain, and such as any bench can run.

Each is made from the conditions of the recording at hand. None knows which effects it is for.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from numpy.random import default_rng

from calib.diagnosis.deciding.bench import BenchTime, Taken
from calib.diagnosis.deciding.bench_blocks import BenchBlocks
from calib.diagnosis.evidence.evidence import Evidence
from calib.forward.schedule import AMBIENT_C
from calib.recording.header import Block

REPEATS = 6
"""Of a reference block."""
FEW = 2
"""Blocks of a plan that is also tried with more lines."""
MORE = 4
"""Times as many lines."""
WARMER_K = 5.0


@dataclass(frozen=True)
class Option:
    """A plan.

    Attributes:
        what: It does, for an operator.
        plan: Its blocks.
        monitor: Whether it is of use with a monitor alone.
    """

    what: str
    plan: tuple[Taken, ...]
    monitor: bool = False


def options(evidence: Evidence, bench: BenchTime) -> tuple[Option, ...]:
    """Return the plans, those that saturate left out."""
    family = _Family(evidence, bench)
    found = [*family.darks(), *family.orders(), *family.in_time(), *family.levels()]
    found += [*family.darks_and_levels(), *family.scenes(), *family.longer(), *family.warmer()]
    return tuple(option for option in found if option.plan)


class _Family:
    def __init__(self, evidence: Evidence, bench: BenchTime) -> None:
        self._table, self._bench = evidence.table, bench
        self._blocks = BenchBlocks.of(evidence, reads_monitor=bool(bench.has_monitor))
        self._lines = self._blocks.lines
        self._exposures, self._levels = self._blocks.exposures, self._blocks.levels

    def darks(self) -> Iterator[Option]:
        shortest, *_, longest = (self._exposures * 2)[: max(2, len(self._exposures))]
        yield Option("a dark at the longest exposure", (self._blocks.dark(longest),))
        if len(self._exposures) > 1:
            pair = (self._blocks.dark(shortest), self._blocks.dark(longest))
            yield Option("darks at the shortest and the longest exposure", pair)
            every = tuple(self._blocks.dark(t) for t in self._exposures)
            yield Option("darks at every exposure", every)
            back = (*reversed(every), *every)
            yield Option("darks at every exposure, down and up again", back)

    def orders(self) -> Iterator[Option]:
        """Yield the recording's own conditions in other orders."""
        seen = self._blocks.seen()
        yield Option("the same blocks from the last to the first", tuple(reversed(seen)))
        rising = sorted(seen, key=lambda t: (t.burning, t.block.exposure_us))
        yield Option("the same blocks up and down", (*rising, *reversed(rising)))
        shuffled = default_rng(len(seen)).permutation(len(seen))
        yield Option("the same blocks shuffled", tuple(seen[int(i)] for i in shuffled))

    def in_time(self) -> Iterator[Option]:
        """Yield one flat again and again, with a monitor too where there may be one."""
        flats = [t for t in self._blocks.seen() if t.block.kind == "flat"]
        if not flats:
            return
        best = max(flats, key=lambda t: t.burning * t.block.exposure_us)
        lasted = float(self._table.started_s[-1] - self._table.started_s[0])
        for wait_s, how in (
            (0.0, "again and again"),
            (lasted / REPEATS, "spread over as long a time as the recording"),
            (4.0 * lasted / REPEATS, "spread over four times as long a time as the recording"),
        ):
            plan = tuple(replace(best, wait_s=wait_s) for _ in range(REPEATS))
            yield Option(f"the brightest flat {how}", plan)
            if self._bench.has_monitor is None:
                read = tuple(replace(t, block=_read(t.block)) for t in plan)
                yield Option(f"the brightest flat {how}, a monitor read", read, monitor=True)

    def levels(self) -> Iterator[Option]:
        """Yield flats at another level, and a pair of levels at one dose."""
        highest = self._bench.max_level or max(self._levels)
        longest = self._exposures[-1]
        for level in sorted({self._levels[0], min(2.0 * self._levels[0], highest), highest}):
            plan = [self._blocks.flat(t, level) for t in self._exposures]
            yield Option(f"flats at level {level:g} at all exposures", _whole(plan))
            if (level, longest) not in self._blocks.recorded:
                one = _whole([self._blocks.flat(longest, level)])
                yield Option(f"a flat of {longest:g} us at level {level:g}", one)
        level = self._levels[0]
        if 2.0 * level <= highest:
            pair = _whole(
                [self._blocks.flat(longest, level), self._blocks.flat(longest / 2, 2.0 * level)]
            )
            yield Option("two levels at equal dose", pair)

    def darks_and_levels(self) -> Iterator[Option]:
        """Yield a dark and flats at another level."""
        dark, highest = self._blocks.dark(self._exposures[-1]), self._bench.max_level or 0.0
        for level in sorted({self._levels[0], min(2.0 * self._levels[0], highest or 1e9), highest}):
            for plan in (self._exposures[-1:], self._exposures):
                flats = [self._blocks.flat(t, level) for t in plan] if level > 0 else [None]
                what = "a flat" if len(plan) == 1 else "flats at all exposures"
                taken = _whole([dark, *flats])
                yield Option(f"a dark at the longest exposure and {what} at level {level:g}", taken)

    def scenes(self) -> Iterator[Option]:
        if not self._bench.shows_scenes or len(self._exposures) < 2:
            return
        for level in self._levels[-1:]:
            for more in (1, MORE):
                plan = [
                    self._blocks.scene(t, level, more)
                    for t in (self._exposures[0], self._exposures[-1])
                ]
                lines = self._lines * more
                yield Option(f"a bar with edges at two exposures, {lines} lines", _whole(plan))

    def longer(self) -> Iterator[Option]:
        for few in (*self.darks(), *self.levels(), *self.darks_and_levels()):
            if 0 < len(few.plan) <= FEW:
                yield Option(f"{few.what}, {MORE * self._lines} lines", self._more(few.plan))
        seen = self._more(self._blocks.seen())
        yield Option(f"the same blocks, {MORE * self._lines} lines", seen)

    def _more(self, plan: Sequence[Taken]) -> tuple[Taken, ...]:
        longer = {"lines": MORE * self._lines}
        return tuple(replace(t, block=t.block.model_copy(update=longer)) for t in plan)

    def warmer(self) -> Iterator[Option]:
        seen = self._blocks.seen()
        if not seen:
            return
        known = [b.sensor_temperature_c for b in self._table.blocks]
        start = next((t for t in reversed(known) if t is not None), AMBIENT_C)
        warm = {"sensor_temperature_c": start + WARMER_K}
        plan = [replace(t, block=t.block.model_copy(update=warm)) for t in seen]
        plan[0] = replace(plan[0], wait_s=600.0)
        yield Option(f"the same blocks with the sensor {WARMER_K:g} K warmer", tuple(plan))


def _whole(plan: Sequence[Taken | None]) -> tuple[Taken, ...]:
    """Return the plan, or none of it where a block would saturate."""
    kept = [taken for taken in plan if taken is not None]
    return tuple(kept) if len(kept) == len(plan) else ()


def _read(block: Block) -> Block:
    return block.model_copy(update={"monitor": block.level})
