"""What `darkflat mtf` does for a grating, and for an edge."""

from pathlib import Path
from typing import Any

from calib.errors import InputError
from calib.mtf.answer import answer
from calib.mtf.reading import MtfToml
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from service.cli.about import about
from service.cli.set_output import check_set, save_set
from service.evaluation.transfer_function import Method
from service.evaluation.transfer_function import of_edge as edge_result
from service.evaluation.transfer_function import of_grating as grating_result


def of_grating(
    folder: Path,
    read: MtfToml,
    out: Path,
    *,
    method: Method,
    support: int,
    report: Path | None,
    coefficient_set: Path | None,
    set_out: Path | None,
) -> dict[str, Any]:
    """Reduce a scan of a grating; write TF.h5 and what else is asked for; return the answer."""
    carrying = None if coefficient_set is None else CoefficientSet.load(coefficient_set)
    with about(folder):
        result = grating_result(folder, read, method, support)
    told = {**answer(result), "path": str(out), "report": None, "coefficient_set": None}
    made = None if carrying is None else carrying.with_transfer_function(result.reference())
    if made is not None and set_out is not None:
        check_set(made, set_out)
        told["coefficient_set"] = made.id
    result.save(out)
    if made is not None and set_out is not None:
        save_set(made, set_out)
    if report is not None:
        from calib.mtf.report.page import write_report  # noqa: PLC0415  (matplotlib is slow)

        write_report(report, result)
        told["report"] = str(report)
    return told


def of_edge(
    folder: Path,
    read: MtfToml,
    out: Path,
    *,
    report: Path | None,
    coefficient_set: Path | None,
) -> dict[str, Any]:
    """Reduce an edge's images; the answer is that of a grating in one direction."""
    if report is not None or coefficient_set is not None:
        msg = f"{folder} holds an edge, which tells of one direction alone: leave out --report and"
        raise InputError(f"{msg} --set, or record a grating", code="edge-only")
    with about(folder):
        result = edge_result(folder, read)
        found = result.answer()
    told = {**found, "path": str(out), "report": None, "coefficient_set": None}
    result.save(out)
    return told
