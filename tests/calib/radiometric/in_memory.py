"""A recording that lives in memory, drawn by the forward model."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from numpy.random import Generator

from calib.arrays import RawLines
from calib.forward.model import Model
from calib.forward.simulate import simulate
from calib.recording.digest import digest_of
from calib.recording.header import Block, RecordingHeader


@dataclass(frozen=True)
class InMemory:
    """`Recording` without a file."""

    header: RecordingHeader
    stretches: dict[str, tuple[RawLines, ...]]
    path: Path = Path("in-memory")
    warnings: tuple[str, ...] = ()

    def frames(self, block: str) -> Iterator[RawLines]:
        yield from self.stretches[block]

    def digest(self) -> str:
        return digest_of(self)


def record(model: Model, blocks: Sequence[Block], rng: Generator, lines: int) -> InMemory:
    """Draw `blocks` in frames of `lines` lines."""
    drawn = [(b, tuple(frames)) for b, frames in simulate(model, blocks, rng, frame_lines=lines)]
    header = RecordingHeader(
        camera=model.camera, source=model.source, blocks=tuple(b for b, _ in drawn)
    )
    return InMemory(header, {b.block: frames for b, frames in drawn})


def agcam_plan(lines: int, sweep_level: int = 1) -> list[Block]:
    """The paper's exposure sweep at one level and lamp-level sweep at 100 µs, with darks."""
    blocks = []
    for t in (100.0, 200.0, 300.0, 400.0, 500.0):
        blocks.append(("flat", t, sweep_level))
        blocks.append(("dark", t, 0))
    blocks += [("flat", 100.0, level) for level in (1, 2, 3, 4, 5, 6)]
    return [
        Block(block=f"{k:03d}", kind=kind, exposure_us=t, level=g, lines=lines)
        for k, (kind, t, g) in enumerate(blocks)
    ]
