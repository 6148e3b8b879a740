"""Writing a recording frame by frame, so that no acknowledged frame is ever lost.

For each frame, in this order: its chunk goes to the file, the file is flushed, its line goes to
the commit record. Once `append` returns, the death of the process cannot take the frame. At the
end of a block both files are also brought to the disk itself (fsync; the frames first, then the
line that ends the block), so that a power cut costs no more than the unfinished block, as long as
the file system keeps its promises.
"""

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.closing import Closing
from calib.errors import DarkflatError, InputError
from calib.recording.block_order import check_new_block, check_order
from calib.recording.commit_log import Entry
from calib.recording.file_layout import Provenance
from calib.recording.frame_codes import checked_codes, crc32_of, sample_shape
from calib.recording.frame_record import FrameRecord
from calib.recording.frame_store import FrameStore
from calib.recording.header import Block, RecordingHeader
from calib.recording.opened import OpenedRecording
from calib.recording.salvage import reopen
from calib.recording.start import start


class RecordingWriter(Closing):
    """One recording being written by one process; a context manager.

    Leaving the context closes the file. A block not ended by then stays unfinished: readers leave
    it out, and after `resume` it is done again.
    """

    def __init__(self, opened: OpenedRecording) -> None:
        """Take over an open recording; use `create` or `resume`."""
        self.path = opened.path
        self.plan = opened.plan
        self._store = FrameStore(opened.file, opened.path)
        self._log = opened.log
        self._header = opened.header
        self._whole = [recorded.block for recorded in opened.state.whole]
        self._notes = list(opened.state.notes)
        self._next_index = opened.state.n_frames
        self._open: Block | None = None
        self._open_lines = 0

    @classmethod
    def create(
        cls,
        path: Path | str,
        header: RecordingHeader,
        frame_lines: int,
        *,
        plan: str = "",
        features: Mapping[str, str] | None = None,
        scenes: Mapping[str, NDArray[np.float64]] | None = None,
    ) -> "RecordingWriter":
        """Start a recording; `header.blocks` is not used, blocks come by `begin_block`.

        Args:
            path: The .h5 file; InputError `output-exists` where it is there already.
            header: The camera and the source.
            frame_lines: Lines of each frame (frames per chunk of an area sensor); a frame may
                have fewer, not more.
            plan: The plan's text.
            features: The camera's feature dump.
            scenes: Radiance images that blocks of kind `scene` name.
        """
        before = Provenance(plan, features or {}, scenes or {})
        return cls(start(Path(path), header, frame_lines, before, started_ns=time.time_ns()))

    @classmethod
    def resume(cls, path: Path | str) -> "RecordingWriter":
        """Continue a recording whose writer was killed, or closed it early.

        Frames without a commit line and a torn last line are dropped, every CRC of what stays is
        verified, and the frames of an unfinished block are superseded: the block is to be done
        again from its first frame. The gap is noted.
        """
        opened = reopen(Path(path))
        writer, state = cls(opened), opened.state
        gap_s = (time.time_ns() - state.last_at_ns) * 1e-9
        again = ""
        if state.unfinished is not None:
            name = state.unfinished.block.block
            writer._commit({"kind": "superseded", "block": name})
            again = f"; block {name} is done again from its first frame"
        writer.note(f"resumed after a gap of {gap_s:.1f} s{again}")
        return writer

    @property
    def header(self) -> RecordingHeader:
        """Camera, source, and the blocks that are whole so far."""
        return self._header.model_copy(update={"blocks": tuple(self._whole)})

    @property
    def whole_blocks(self) -> tuple[str, ...]:
        """The names of the blocks that need not be done again."""
        return tuple(block.block for block in self._whole)

    @property
    def open_block(self) -> str | None:
        """The name of the block that is being recorded; None between blocks."""
        return None if self._open is None else self._open.block

    @property
    def notes(self) -> tuple[str, ...]:
        """Everything noted so far, gaps among it."""
        return tuple(self._notes)

    def begin_block(self, block: Block) -> None:
        """Start `block` with its conditions as planned; frames that follow are its own."""
        if self._open is not None:
            raise DarkflatError(
                f"block {self._open.block} is not ended yet: end or discard it before "
                f"{block.block} begins",
                code="block-not-ended",
            )
        check_new_block(self._whole, block, str(self.path))
        self._commit({"kind": "begin", "block": _to_json(block)})
        self._open, self._open_lines = block, 0

    def append(self, dn: RawLines, record: FrameRecord | None = None) -> int:
        """Write and commit one frame, (n_lines, n_columns) or an area sensor's; return its index.

        One frame of an area sensor may come as (n_rows, n_columns).
        """
        block = self._open_block()
        if dn.ndim == len(sample_shape(self._header.camera)) and self._header.camera.rows:
            dn = dn[np.newaxis]
        codes = checked_codes(dn, self._header.camera, f"a frame of block {block.block}")
        if len(codes) > self._store.frame_lines:
            raise InputError(
                f"a frame of block {block.block} has {len(codes)} lines, but the recording was "
                f"started with {self._store.frame_lines} lines per frame: split it",
                code="frames-wrong-shape",
            )
        index = self._next_index
        self._store.write(index, codes)
        commit = {"index": index, "block": block.block, "lines": len(codes)}
        commit["crc32"] = crc32_of(codes)
        self._commit({"kind": "frame", **commit, **(record or FrameRecord()).to_json()})
        self._next_index += 1
        self._open_lines += len(codes)
        return index

    def lost(self, block: str, reason: str, frame_id: int | None = None) -> None:
        """Note a frame that did not arrive whole; nothing is padded for it."""
        self._commit({"kind": "lost", "block": block, "reason": reason, "frame_id": frame_id})

    def end_block(self, block: Block) -> None:
        """End the block with its conditions as read back; now it is whole, and on the disk."""
        begun = self._open_block()
        if block.block != begun.block:
            raise DarkflatError(
                f"block {block.block} cannot end while {begun.block} is being recorded",
                code="block-not-begun",
            )
        if block.lines not in (None, self._open_lines) or self._open_lines == 0:
            raise InputError(
                f"block {block.block} ends with {self._open_lines} lines, but its conditions say "
                f"{block.lines}: record the rest, or give the number recorded",
                code="lines-mismatch",
            )
        check_order(self._whole, block, str(self.path))
        self._store.sync()
        self._commit({"kind": "end", "block": _to_json(block)})
        self._log.sync()
        self._whole.append(block)
        self._open = None

    def discard_block(self, reason: str) -> None:
        """Give up the block being recorded; its frames stay in the file but no longer count."""
        block = self._open_block().block
        self._commit({"kind": "superseded", "block": block})
        self._open = None
        self.note(f"block {block} discarded: {reason}")

    def note(self, text: str) -> None:
        """Keep `text` with its time."""
        self._commit({"kind": "note", "text": text})
        self._notes.append(text)

    def close(self) -> None:
        """Close both files; safe to call twice."""
        try:
            self._store.close()
        finally:
            self._log.close()

    def _open_block(self) -> Block:
        if self._open is None:
            raise DarkflatError(
                f"no block of {self.path} is being recorded: begin one first",
                code="block-not-begun",
            )
        return self._open

    def _commit(self, entry: Entry) -> None:
        self._log.append({**entry, "at_ns": time.time_ns()})


def _to_json(block: Block) -> dict[str, Any]:
    return block.model_dump(mode="json")
