"""Writing a coefficient set where the caller wants it, and reading one from where he says."""

from pathlib import Path

from calib.errors import InputError
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.correction.apply_checks import Validity
from calib.recording.durable import refuse_existing


def save_set(coefficients: CoefficientSet, out: Path) -> None:
    """Write the set to `out`; a file that is there already is kept, unless it is the same set."""
    check_set(coefficients, out)
    coefficients.save(out)


def check_set(coefficients: CoefficientSet, out: Path) -> None:
    """Refuse an `out` that is there already, unless it is the same set."""
    if out.exists() and _id_of(out) != coefficients.id:
        refuse_existing(out)


def check_distinct(*outputs: Path | None) -> None:
    """Refuse outputs of which one would be written over another."""
    named = [each for each in outputs if each is not None]
    for k, each in enumerate(named):
        if each.resolve() in {other.resolve() for other in named[:k]}:
            msg = f"{each} is named for two outputs: name another for one of them"
            raise InputError(msg, code="output-named-twice")


def check_report(report: Path | None) -> None:
    """Say before the long work, and not after it, that a report has no place to go to."""
    if report is None:
        return
    if report.is_dir() or not report.parent.is_dir():
        msg = f"the report cannot be written to {report}: name a file in a folder that is there"
        raise InputError(msg, code="cannot-write")
    refuse_existing(report)


def _id_of(path: Path) -> str | None:
    try:
        return CoefficientSet.load(path).id
    except InputError:
        return None


def load_set(named: str) -> tuple[CoefficientSet, Validity | None]:
    """Return the set in the file `named`, or of that id in the store with its validity."""
    path = Path(named)
    if path.exists() or path.suffix or len(path.parts) > 1:
        return CoefficientSet.load(path), None
    from service.cli.opened_store import opened_store  # noqa: PLC0415

    with opened_store() as store:
        record = store.sets.get(named)
        coefficients = store.sets.files.load(record.id)
    held = record.certification
    if held is None or record.state == "revoked":
        msg = f"coefficient set {record.id[:12]} is {record.state}, not certified; give its file"
        raise InputError(msg, code="not-certified")
    return coefficients, Validity(held.valid_from, held.until)
