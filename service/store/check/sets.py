"""Coefficient sets: each record's file holds what its name and its record say."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from calib.errors import InputError
from service.store.check.finding import Finding, Kind
from service.store.records import SetRecord
from service.store.set_files import SetFiles

if TYPE_CHECKING:
    from calib.radiometric.coefficients.coefficient_set import CoefficientSet


def check_set(record: SetRecord, files: SetFiles, logged: str | None) -> Iterator[Finding]:
    """Compare a set's record with its file, and its state with what was `logged` of it last.

    Nothing is logged of a set that was added before there was a log.
    """
    path, name = files.path(record.id), f"coefficient set {record.id[:12]}"
    if not path.is_file():
        text = f"the file of {name} is gone; restore it from a copy"
        yield Finding(Kind.MISSING, record.id, path, text)
    else:
        try:
            stored = files.load(record.id)
        except InputError as error:
            yield Finding(Kind.ALTERED, record.id, path, f"{error} ({name})")
        else:
            yield from _compared(record, stored, path)
    last_step = record.transitions[-1].after if record.transitions else None
    if record.state != last_step or logged not in {None, f"coefficient-set.{record.state}"}:
        text = (
            f"{name} is on record as {record.state}, but its life ends with"
            f" {last_step or 'nothing'} and the audit log with {logged or 'nothing'}; compare the"
            " database with a copy"
        )
        yield Finding(Kind.ALTERED, record.id, None, text)


def _compared(record: SetRecord, stored: "CoefficientSet", path: Path) -> Iterator[Finding]:
    camera = stored.camera
    in_file = {
        "camera_serial": camera.serial,
        "band": camera.band,
        "gain_db": camera.gain_db,
        "bit_depth": camera.bit_depth,
        "columns": camera.columns,
        "region": camera.region,
        "radiance_unit": stored.radiance_unit,
        "recording_digest": stored.provenance.recording_digest,
    }
    for name, value in in_file.items():
        if getattr(record, name) != value:
            text = (
                f"the record of coefficient set {record.id[:12]} says {name} ="
                f" {getattr(record, name)!r}, and its file {value!r}; compare the database with a"
                " copy"
            )
            yield Finding(Kind.ALTERED, record.id, path, text)
