"""What a commit record amounts to: whole blocks, an unfinished one, what was lost.

Kinds of lines: `recording` (the first: identity), `begin` (block begun), `frame`, `lost` (frame),
`end` (block ended, with its conditions as read back), `superseded` (an unfinished block's frames
no longer count), `note`. Each has `at_ns`, the host's clock, Unix time.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from calib.errors import InputError
from calib.recording.commit_log import Entry
from calib.recording.frame_record import CommittedFrame, FrameRecord
from calib.recording.header import Block

FORMAT = 1


@dataclass(frozen=True)
class LostFrameRecord:
    """A frame that did not arrive whole; another was taken for it."""

    block: str
    reason: str
    frame_id: int | None


@dataclass(frozen=True)
class RecordedBlock:
    """A block and its frames, in the order of acquisition."""

    block: Block
    frames: tuple[CommittedFrame, ...] = ()

    @property
    def lines(self) -> int:
        """Lines (frames of an area sensor) committed so far."""
        return sum(frame.lines for frame in self.frames)


@dataclass(frozen=True)
class CommitState:
    """The sum of a commit record's lines.

    Attributes:
        recording_id: Stands in the .h5 file too, so that the two cannot be mixed up.
        whole: Blocks begun and ended.
        unfinished: A block begun and not ended; it is done again from its first frame.
        superseded: Frames of unfinished blocks that no longer count; they stay in the file.
        lost: Frames that did not arrive whole.
        notes: Free text, gaps among it.
        n_frames: Frames committed, superseded ones included: the next frame's index.
        last_at_ns: When the last line was written.
    """

    recording_id: str
    whole: tuple[RecordedBlock, ...] = ()
    unfinished: RecordedBlock | None = None
    superseded: tuple[CommittedFrame, ...] = ()
    lost: tuple[LostFrameRecord, ...] = ()
    notes: tuple[str, ...] = ()
    n_frames: int = 0
    last_at_ns: int = 0

    @property
    def every_frame(self) -> tuple[CommittedFrame, ...]:
        """All committed frames, superseded and unfinished ones too."""
        open_frames = self.unfinished.frames if self.unfinished else ()
        whole = tuple(frame for block in self.whole for frame in block.frames)
        return (*self.superseded, *whole, *open_frames)


class _Replay:
    """Goes through the lines one by one; each kind of line has its method."""

    def __init__(self, first: Entry) -> None:
        self.recording_id = str(first["id"])
        self.whole: list[RecordedBlock] = []
        self.open_block: Block | None = None
        self.open_frames: list[CommittedFrame] = []
        self.superseded: list[CommittedFrame] = []
        self.lost: list[LostFrameRecord] = []
        self.notes: list[str] = []
        self.n_frames = 0

    def begin(self, entry: Entry) -> None:
        if self.open_block is not None:
            raise ValueError("a block begun before the one before it ended")
        self.open_block = Block.model_validate(entry["block"])

    def frame(self, entry: Entry) -> None:
        if self.open_block is None or entry["block"] != self.open_block.block:
            raise ValueError("a frame outside its block")
        if entry["index"] != self.n_frames:
            raise ValueError(f"frame {entry['index']} where {self.n_frames} comes next")
        self.open_frames.append(
            CommittedFrame(
                int(entry["index"]),
                str(entry["block"]),
                int(entry["lines"]),
                int(entry["crc32"]),
                FrameRecord.from_json(entry),
            )
        )
        self.n_frames += 1

    def end(self, entry: Entry) -> None:
        ended = Block.model_validate(entry["block"])
        if self.open_block is None or ended.block != self.open_block.block:
            raise ValueError("a block ended that was not begun")
        self.whole.append(RecordedBlock(ended, tuple(self.open_frames)))
        self.open_block, self.open_frames = None, []

    def supersede(self, _entry: Entry) -> None:
        self.superseded.extend(self.open_frames)
        self.open_block, self.open_frames = None, []

    def lose(self, entry: Entry) -> None:
        self.lost.append(LostFrameRecord(entry["block"], entry["reason"], entry["frame_id"]))

    def note(self, entry: Entry) -> None:
        self.notes.append(str(entry["text"]))

    def state(self) -> CommitState:
        unfinished = (
            RecordedBlock(self.open_block, tuple(self.open_frames)) if self.open_block else None
        )
        return CommitState(
            self.recording_id,
            tuple(self.whole),
            unfinished,
            tuple(self.superseded),
            tuple(self.lost),
            tuple(self.notes),
            self.n_frames,
        )


def replay(entries: Iterable[Entry], path: Path) -> CommitState:
    """Return what `entries` amount to; InputError where they contradict each other."""
    lines = list(entries)
    try:
        if not lines or lines[0]["kind"] != "recording" or lines[0]["format"] != FORMAT:
            raise ValueError("it does not begin with a line of kind `recording`, format 1")
        replaying = _Replay(lines[0])
        steps: dict[str, Any] = {
            "begin": replaying.begin,
            "frame": replaying.frame,
            "end": replaying.end,
            "superseded": replaying.supersede,
            "lost": replaying.lose,
            "note": replaying.note,
        }
        for number, entry in enumerate(lines[1:], start=2):
            if entry["kind"] not in steps:
                raise ValueError(f"line {number} is of the unknown kind {entry['kind']!r}")
            steps[entry["kind"]](entry)
        return replace(replaying.state(), last_at_ns=int(lines[-1].get("at_ns", 0)))
    except (KeyError, TypeError, ValueError, ValidationError) as error:
        raise InputError(
            f"the commit record {path} contradicts itself ({error}): restore it from a copy",
            code="commit-record-damaged",
        ) from error
