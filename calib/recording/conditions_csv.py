"""`conditions.csv`: one row per block, in the order of acquisition.

An empty cell is unknown, None. Columns that darkflat does not know are kept: a cell that is
exactly a JSON number, true, false or a quoted string is that value, anything else is text.
"""

import csv
import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from calib.errors import InputError, reason_of
from calib.recording.block_order import check_new_block
from calib.recording.header import Block
from calib.recording.recording_toml import first_problem

REQUIRED = (
    "block",
    "kind",
    "exposure_us",
    "level",
    "started_s",
    "sensor_temperature_c",
    "lines",
    "radiance",
)
OWN = {
    "gain_db", "lamp_currents_a", "level_read_back", "monitor_before_a", "monitor_after_a",
    "brightest_column_dn",
}  # fmt: skip
"""What a sweep of ours adds: kept like any other column, and no surprise."""
_TEXT = {"block", "kind", "scene"}


def read_rows(path: Path, required: Sequence[str]) -> tuple[list[str], list[dict[str, str]]]:
    """Return the columns' names and the rows of a CSV file; InputError where some are missing."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError as error:
        raise InputError(
            f"{path.name} is missing in {path.parent}: add it", code="recording-incomplete"
        ) from error
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            f"{path} cannot be read ({reason_of(error)}): save it as UTF-8 text",
            code="conditions-invalid",
        ) from error
    reader = csv.reader(io.StringIO(text), skipinitialspace=True)
    lines = [[cell.strip() for cell in row] for row in reader if any(cell.strip() for cell in row)]
    columns = lines[0] if lines else []
    missing = [name for name in required if name not in columns]
    if missing or len(set(columns)) < len(columns):
        problem = f"lacks the column(s) {', '.join(missing)}" if missing else "has a column twice"
        raise InputError(
            f"{path} {problem}: each stands there once; leave cells empty where a value is unknown",
            code="conditions-missing-columns",
        )
    for number, row in enumerate(lines[1:], start=2):
        if len(row) != len(columns):
            raise InputError(
                f"{path}, row {number}: {len(row)} cells under {len(columns)} columns: correct it",
                code="conditions-invalid",
            )
    return columns, [dict(zip(columns, row, strict=True)) for row in lines[1:]]


def read_conditions(path: Path) -> tuple[tuple[Block, ...], tuple[str, ...]]:
    """Return the blocks in their order, and a warning for every unknown column."""
    columns, rows = read_rows(path, REQUIRED)
    blocks: list[Block] = []
    for number, row in enumerate(rows, start=2):
        where = f"{path}, row {number}"
        block = _block(row, where)
        check_new_block(blocks, block, where)
        blocks.append(block)
    if not blocks:
        raise InputError(f"{path} has no rows: one per block", code="recording-incomplete")
    unknown = [name for name in columns if name not in Block.model_fields and name not in OWN]
    return tuple(blocks), tuple(f"{path}: unknown column {name} is kept" for name in unknown)


def conditions_to_csv(blocks: Sequence[Block]) -> str:
    """Return the text of `conditions.csv`; reading it gives equal blocks."""
    extra = {name: None for block in blocks for name in block.model_extra or {}}
    used = [
        name for name in ("monitor", "scene") if any(getattr(b, name) is not None for b in blocks)
    ]
    columns = [*REQUIRED, *used, *extra]
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(columns)
    for block in blocks:
        content = block.model_dump(mode="json")
        writer.writerow([_cell(name, content.get(name)) for name in columns])
    return out.getvalue()


def _block(row: dict[str, str], where: str) -> Block:
    content = {name: _value(name, cell) for name, cell in row.items()}
    if content["level"] is None:
        if content["kind"] != "dark":
            raise InputError(
                f"{where}: level is empty: give the number of lamps that burned or the LED's "
                "setting",
                code="conditions-invalid",
            )
        content["level"] = 0.0
    try:
        return Block.model_validate(content)
    except ValidationError as error:
        code = "radiance-invalid" if error.errors()[0]["loc"] == ("radiance",) else None
        raise InputError(
            f"{where}: {first_problem(error)}; correct the cell, or leave it empty where unknown",
            code=code or "conditions-invalid",
        ) from error


def _value(name: str, cell: str) -> Any:  # what a cell may hold
    if not cell:
        return None
    if name in _TEXT or name in Block.model_fields:
        return cell
    try:
        value = json.loads(cell, parse_constant=_no_number)
    except ValueError:
        return cell
    return value if json.dumps(value) == cell else cell


def _no_number(constant: str) -> Any:  # json's signature
    raise ValueError(constant)


def _cell(name: str, value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, str) and (name in _TEXT or _value(name, value.strip()) == value):
        return value
    return json.dumps(value)
