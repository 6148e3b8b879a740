"""Recording files (.h5 with its commit record) that no command can read."""
# ruff: noqa: E501 - a table is read by rows

from tests.test_bad_input.case import Case
from tests.test_bad_input.damage import (
    altered_array,
    cut,
    flipped_byte,
    folder_instead,
    removed,
    renamed,
    replaced,
    written,
)

EXPORT = "export rec.h5 --out out"
RECORD = "rec.frames.jsonl"

CASES = (
    Case("recording not found", "export nowhere.h5 --out out", "recording-not-found", ("nowhere.h5",), "name an .h5 file"),
    Case("recording file truncated", EXPORT, "recording-truncated", ("rec.h5",), "copy it again", cut("rec.h5", 0.6)),
    Case("recording file cut in its first bytes", EXPORT, "recording-unreadable", ("rec.h5",), "from a copy", cut("rec.h5", 0.0002)),
    Case("recording file empty", EXPORT, "recording-unreadable", ("rec.h5",), "from a copy", cut("rec.h5", 0)),
    Case("text in place of a recording", EXPORT, "recording-unreadable", ("rec.h5",), "from a copy", written("rec.h5", "not HDF5 " * 100)),
    Case("a coefficient set in place of a recording", "export set.h5 --out out", "not-a-recording", ("set.h5",), "import its frames"),
    Case("the commit record in place of the recording", f"export {RECORD} --out out", "not-a-recording", (RECORD,), "name the .h5 file"),
    Case("a folder named like a recording", "export odd.h5 --out out", "recording-incomplete", ("odd.h5", "conditions.csv"), "add it", folder_instead("odd.h5")),
    Case("commit record missing", EXPORT, "commit-record-missing", (RECORD,), "put it back", removed(RECORD)),
    Case("commit record renamed", EXPORT, "commit-record-missing", (RECORD,), "put it back", renamed(RECORD, "old.frames.jsonl")),
    Case("commit record empty", EXPORT, "commit-record-damaged", (RECORD,), "from a copy", cut(RECORD, 0)),
    Case("commit record damaged in the middle", EXPORT, "commit-record-damaged", (RECORD, "line 3"), "from a copy", replaced(RECORD, '"kind":"frame"', '"kind:frame"')),
    Case("commit record of another recording", EXPORT, "commit-record-mismatch", (RECORD, "rec.h5"), "put each back", replaced(RECORD, '"id":"', '"id":"0')),
    Case("commit record without a line", EXPORT, "commit-record-damaged", (RECORD,), "from a copy", lambda folder: (folder / RECORD).write_text("".join((folder / RECORD).read_text().splitlines(keepends=True)[:2] + (folder / RECORD).read_text().splitlines(keepends=True)[3:]))),
    Case("commit record of an unknown kind of line", EXPORT, "commit-record-damaged", (RECORD, "line 3"), "from a copy", replaced(RECORD, '"kind":"frame"', '"kind":"fame"')),
    Case("commit record torn before the first block ended", "calibrate rec.h5 --out out.h5", "no-flats", ("rec.h5", "no flat"), "record uniform light", cut(RECORD, 0.06)),
    Case("frames altered", EXPORT, "crc-mismatch", ("block 004", "rec.h5"), "from a copy", altered_array("rec.h5", "frames")),
    Case("header of the recording file damaged", EXPORT, "recording-unreadable", ("rec.h5",), "from a copy", flipped_byte("rec.h5", 0.0001)),
)  # fmt: skip
