"""The data sheet for programs: JSON with every point, and XML as EMVA's group exchanges results.

The XML is `results/<section>/<name>/{Short, Symbol, Value, Unit}` with the section and names of
GitHub EMVA1288/emva1288, doc/datasets/datasets_results.rst, and percent where that has percent;
beside each `Value` stands our `StandardUncertainty`, which readers of that format pass over. A
figure that is not determined has the value nan and says why in `Comment`.
"""

import json
import math
from dataclasses import asdict, is_dataclass
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np

from calib.transfer.emva1288.catalogue import CATALOGUE
from calib.transfer.emva1288.sheet import DataSheet

_PERCENT = frozenset({"QE"})


def to_json(sheet: DataSheet) -> str:
    """Return the answer, and under `curves` every point that it was read from."""
    curves = {
        "transfer": _plain(sheet.transfer),
        "darks": _plain(sheet.darks),
        "spatial": None if sheet.spatial is None else _plain(sheet.spatial),
    }
    told = {**sheet.answer(), "header": sheet.header.model_dump(mode="json"), "curves": curves}
    return json.dumps(told, indent=1, allow_nan=False, ensure_ascii=False) + "\n"


def to_xml(sheet: DataSheet) -> str:
    """Return the results in EMVA's comparison format."""
    root = ET.Element("results")
    sections: dict[str, ET.Element] = {}
    for figure in CATALOGUE:
        if not figure.emva_name:
            continue
        if figure.section not in sections:
            sections[figure.section] = ET.SubElement(root, figure.section)
        known = sheet.figures[figure.name]
        factor = 100.0 if figure.emva_name in _PERCENT else 1.0
        texts = {
            "Short": figure.title,
            "Symbol": figure.symbol,
            "Value": repr(factor * known.value),
            "StandardUncertainty": repr(factor * known.std),
            "Unit": "%" if factor > 1.0 else figure.unit.replace("1", ""),
            "Comment": known.reason,
        }
        one = ET.SubElement(sections[figure.section], figure.emva_name)
        for name, text in texts.items():
            ET.SubElement(one, name).text = text
    _histograms(root, sheet)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def _histograms(root: ET.Element, sheet: DataSheet) -> None:
    if sheet.spatial is None:
        return
    section = ET.SubElement(root, "defect_pixel")
    for name, image in (("DSNU", sheet.spatial.dark), ("PRNU", sheet.spatial.flat)):
        found = image.histogram
        pixels = int(found.count.sum())
        beyond = np.rint(found.share_beyond * pixels).astype(np.int64)
        for tail, bins, values in (
            ("", found.deviation, found.count),
            ("_accumulated", found.distance, beyond),
        ):
            data = ET.SubElement(
                ET.SubElement(section, f"histogram_{name}{tail}"), "Data", unit=image.unit
            )
            ET.SubElement(data, "bins").text = " ".join(map(repr, bins.tolist()))
            ET.SubElement(data, "values").text = " ".join(map(str, values.tolist()))


def _plain(value: Any) -> Any:
    """Return what JSON knows: arrays as lists, NaN as null."""
    if is_dataclass(value) and not isinstance(value, type):
        return {k: _plain(v) for k, v in asdict(value).items()}
    if isinstance(value, dict):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(each) for each in value]
    if isinstance(value, np.ndarray):
        return [_plain(each) for each in value.tolist()]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
