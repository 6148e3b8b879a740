"""Every figure of the data sheet: its name here, in EMVA's XML, its unit and where it is defined.

EMVA's names are those of the group's comparison format (GitHub EMVA1288/emva1288,
doc/datasets/datasets_results.rst) and those that release 4 added in their package.
"""

import csv
from dataclasses import dataclass
from importlib.resources import files


@dataclass(frozen=True)
class Figure:
    """One figure of merit, a row of catalogue.csv.

    Attributes:
        name: Here, and in JSON.
        title: For people.
        symbol: As the standard writes it.
        unit: "1" for a ratio.
        section: EMVA's section in XML.
        emva_name: EMVA's name in XML; "" where it has none.
        source: Where Release 4.0 Linear defines it.
        scaled_by_photons: Power of the photon scale in it, whose error all share: 0, 1 or -1.
    """

    name: str
    title: str
    symbol: str
    unit: str
    section: str
    emva_name: str
    source: str
    scaled_by_photons: int


def _read() -> tuple[Figure, ...]:
    text = files("calib.transfer.emva1288").joinpath("catalogue.csv").read_text("utf-8")
    rows = list(csv.reader(text.splitlines()))[1:]
    return tuple(
        Figure(name, title, symbol, unit, section, emva_name, source, int(power))
        for name, title, symbol, unit, section, emva_name, source, power in rows
    )


CATALOGUE = _read()
"""In the order of the data sheet."""
