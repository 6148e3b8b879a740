"""From an uploaded folder with `mtf.toml` to the pixel's transfer function."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any


def transfer_function(request: Mapping[str, Any], tell: Callable[[float], None]) -> dict[str, Any]:
    """Reduce the folder `scan_path`; return the command's answer, leave TF.h5 and its figures."""
    from calib.mtf.answer import answer  # noqa: PLC0415
    from calib.mtf.reading import read_toml  # noqa: PLC0415
    from calib.mtf.report.page import write_report  # noqa: PLC0415
    from service.api.archive_names import names_of_the_archive  # noqa: PLC0415
    from service.api.jobs.kinds.answer_file import write_answer  # noqa: PLC0415
    from service.evaluation.transfer_function import of_edge, of_grating  # noqa: PLC0415

    folder, files = Path(request["scan_path"]), Path(request["files"])
    with names_of_the_archive(folder):
        read = read_toml(folder)
        if read.edge is not None:
            edge = of_edge(folder, read)
            told = edge.answer()
            edge.save(files / "transfer-function.h5")
        else:
            result = of_grating(folder, read, request["method"], request["support"], progress=tell)
            told = answer(result)
            result.save(files / "transfer-function.h5")
            write_report(files / "report.html", result)
    return write_answer(files, told)
