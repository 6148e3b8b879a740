"""docs/bad-input.md, written from what darkflat really says.

python -m tests.test_bad_input.table    writes the page anew
"""

import os
import re
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from tests.test_bad_input.catalogue import SECTIONS
from tests.test_bad_input.running import run
from tests.test_bad_input.sound import make_sound_files

PAGE = Path(__file__).parents[2] / "docs" / "bad-input.md"
WRITE_ANEW = "python -m tests.test_bad_input.table"
_BEGIN = "<!-- what follows is written by tests/test_bad_input/table.py -->"
_HEAD = "| What is wrong | Typed | What darkflat says | Code |\n|---|---|---|---|\n"
_FOLDER = "work"  # in which `run` works
_TIME = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d[.\d]*(Z|[+-]\d\d:\d\d)?")


@dataclass(frozen=True)
class Row:
    """One row of the page, each cell as it is printed."""

    situation: str
    command: str
    sentence: str
    code: str

    def __str__(self) -> str:
        return f"| {self.situation} | `{self.command}` | {self.sentence} | `{self.code}` |\n"


def cell(text: str) -> str:
    """Return `text` for a table: times, the run's own folder and its process taken out."""
    plain = re.sub(rf"/\S*/{_FOLDER}/", "/…/", _TIME.sub("…", text))
    plain = plain.replace(f"bad-input-{os.getpid()}", "bad-input")
    return plain.replace("\\", "\\\\").replace("|", "\\|").replace("<", "&lt;").replace("*", "\\*")


@cache
def rows() -> dict[str, Row]:
    """Return the page's rows by situation."""
    found = {}
    for line in PAGE.read_text(encoding="utf-8").split(_BEGIN)[1].splitlines():
        cells = [each.strip() for each in re.split(r"(?<!\\)\|", line)[1:-1]]
        if len(cells) == 4 and cells[1].startswith("`"):
            row = Row(cells[0], cells[1].strip("`"), cells[2], cells[3].strip("`"))
            found[row.situation] = row
    return found


def _sections(folder: Path) -> Iterator[str]:
    sound = folder / "sound"
    sound.mkdir()
    make_sound_files(sound)
    for section in SECTIONS:
        yield f"\n## {section.title}\n\n{_HEAD}"
        for number, case in enumerate(section.cases):
            error = run(case, sound, folder / section.title / str(number)).error
            sentence = cell(error["message"])
            yield str(Row(case.situation, case.command, sentence, error["code"]))


def main() -> None:
    """Write the page anew; what stands before the tables stays."""
    before = PAGE.read_text(encoding="utf-8").split(_BEGIN)[0]
    with tempfile.TemporaryDirectory() as folder:
        PAGE.write_text(before + _BEGIN + "\n" + "".join(_sections(Path(folder))), encoding="utf-8")


if __name__ == "__main__":
    main()
