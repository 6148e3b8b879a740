"""Outputs that cannot be written where they were asked for."""
# ruff: noqa: E501 - a table is read by rows

from tests.test_bad_input.case import Case
from tests.test_bad_input.damage import written

COMMANDS = {
    "import": "import rec --out {}",
    "simulate": "simulate demo plan.toml --out {}",
    "sweep": "sweep plan.toml --bench bench.toml --out {}",
    "apply": "apply set.h5 rec --out {}",
    "calibrate": "calibrate rec --out {}",
    "export": "export rec.h5 --out {}",
}
IN_A_FILE = {name: command.format("plan.toml/out.h5") for name, command in COMMANDS.items()}
TAKEN = {name: command.format("taken.h5") for name, command in COMMANDS.items()}

CASES = (
    *(Case(f"output of {name} is there already", command, "output-exists", ("taken.h5",), "name another output", written("taken.h5", "do not lose this")) for name, command in TAKEN.items()),
    *(Case(f"output of {name} in a file as if it were a folder", command, "no-such-folder" if name == "sweep" else "cannot-write", ("plan.toml",), "make it first" if name == "sweep" else "folder") for name, command in IN_A_FILE.items()),
    *(Case(f"output of {name} is a folder", command, "output-exists", ("taken.h5",), "name another output", written("taken.h5/thesis.txt", "do not lose this")) for name, command in TAKEN.items()),
    Case("output of simulate as a folder is there already", "simulate demo plan.toml --out rec", "output-exists", ("rec",), "name another output"),
    Case("output over its own input", "import rec --out rec.h5", "output-exists", ("rec.h5",), "name another output"),
    Case("corrected lines over their own recording", "apply set.h5 rec.h5 --out rec.h5", "output-exists", ("rec.h5",), "name another output"),
    Case("a calibration over its own recording", "calibrate rec.h5 --out rec.h5", "output-exists", ("rec.h5",), "name another output"),
    Case("a commit record in the way", "import rec --out new.h5", "output-exists", ("new.frames.jsonl",), "name another output", written("new.frames.jsonl", '{"kind":"recording"}\n')),
    Case("output without the ending .h5", "import rec --out rec2", "output-not-h5", ("rec2",), "name it rec2.h5"),
    Case("a report that cannot be written", "calibrate rec --out out.h5 --report plan.toml/report.html", "cannot-write", ("report.html",), "name a file"),
)  # fmt: skip
