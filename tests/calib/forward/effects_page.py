"""docs/effects.md, whose table is written from what the effects say of themselves.

python -m tests.calib.forward.effects_page    writes the table anew
"""

import inspect
import itertools
from math import inf
from pathlib import Path

from calib.forward.departure import Departure
from calib.forward.effect import Effect
from calib.forward.effects.catalogue import CATALOGUE
from calib.forward.parameter import Parameter, parameters_of
from calib.recording.header import Block, CameraHeader

PAGE = Path(__file__).parents[3] / "docs" / "effects.md"
WRITE_ANEW = "python -m tests.calib.forward.effects_page"
BEGIN = "<!-- what follows is written by tests/calib/forward/effects_page.py -->\n"
_HEAD = (
    "| Stage | Effect | What it does | Parameters | Shows in; follows | Needs | Source |\n"
    "|---|---|---|---|---|---|---|\n"
)
_CAMERA = CameraHeader(columns=8, bit_depth=12, taps=2, tap_layout="odd_even")
_GROWING = [
    Block(block="0", kind="flat", exposure_us=10.0, level=1, lines=1),
    Block(block="1", kind="flat", exposure_us=10.0, level=2, lines=30),
    Block(block="2", kind="flat", exposure_us=20.0, level=2, lines=30, sensor_temperature_c=20),
    Block(block="3", kind="dark", exposure_us=10.0, lines=30, sensor_temperature_c=30),
    Block(block="4", kind="flat", exposure_us=40.0, level=3, lines=30),
    Block(block="5", kind="flat", exposure_us=10.0, level=2, lines=30),
]


def needs(kind: type[Departure]) -> list[str]:
    """Return all that `kind` asks for, found by plans that hold ever more."""
    found: dict[str, None] = {}
    for n in range(len(_GROWING) + 1):
        for blocks in itertools.combinations(_GROWING, n):
            lack = kind.why_not_testable(blocks, _CAMERA)
            if lack is not None:
                found[lack.removeprefix("needs ")] = None
    return list(found)


def source(kind: type[Effect]) -> str:
    """Return the paragraph of the module's docstring that names where the physics is from."""
    text = inspect.getdoc(inspect.getmodule(kind)) or ""
    return text.split("Source: ")[1].split("\n\n")[0]


def row(kind: type[Effect]) -> str:
    """Return one row of the table."""
    formula = (inspect.getdoc(kind) or "").split("\n\n")[0]
    parameters = "<br>".join(_told(n, p, kind) for n, p in parameters_of(kind).items())
    cells = [kind.stage.name.lower(), f"`{kind.name}`"]
    if issubclass(kind, Departure):
        follows = ", ".join(kind.depends_on)
        formula = f"{kind.physics} {formula}"
        cells += [formula, parameters, f"{kind.shows_in}; {follows}", "; ".join(needs(kind))]
    else:
        cells += [formula, parameters, "", ""]
    return "| " + " | ".join(_cell(text) for text in [*cells, source(kind)]) + " |\n"


def _told(name: str, told: Parameter, kind: type[Effect]) -> str:
    """Return a parameter with its unit, bounds and default."""
    default = getattr(kind(), name)
    if told.choices:
        return f"`{name}`: {', '.join(told.choices)}"
    unit = "" if told.unit == "1" else f" {told.unit}"
    bounds = f", {told.low:g} to {told.high:g}" if told.high < inf else ""
    value = "not given" if default in {(), None} else f"{default}"
    return f"`{name}` = {value}{unit}{bounds}"


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|").replace("*", "\\*")


def table() -> str:
    """Return the table of all effects, in the order of the chain."""
    return _HEAD + "".join(row(kind) for kind in CATALOGUE)


def main() -> None:
    """Write the table anew; what stands before it stays."""
    before = PAGE.read_text(encoding="utf-8").split(BEGIN)[0]
    PAGE.write_text(before + BEGIN + table(), encoding="utf-8")


if __name__ == "__main__":
    main()
