"""What could be seen in each case, worked out once the diagnoses are there."""

import json
import math
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from tests.concealed.generator.case import Case
from tests.concealed.ideal.angles import nearest_name
from tests.concealed.ideal.sight import sight
from tests.concealed.scoring.run import finished

Visibility = tuple[float, float, str]
"""Sight and distance to the nearest other name, standard deviations, and that name."""
Visible = dict[int, tuple[Visibility, ...]]
"""By case, of each hidden effect."""
NOT_KNOWN: Visibility = (math.nan, math.nan, "")


def visible_in(cases: Sequence[Case], out: Path, *, workers: int = 1) -> Visible:
    """Return it of each finished case; what is known is kept in `visible.jsonl`."""
    path, done = out / "visible.jsonl", finished(out)
    known = _read(path)
    waiting = [case for case in cases if case.number in done and case.number not in known]
    if workers == 1:
        _keep(path, known, waiting, map(visibility, waiting))
    else:
        with ProcessPoolExecutor(workers) as pool:
            _keep(path, known, waiting, pool.map(visibility, waiting, chunksize=4))
    return known


def visibility(case: Case) -> tuple[Visibility, ...]:
    """Return it of one case."""
    seen = sight(case)
    near = nearest_name(case, seen)
    return tuple((z, apart, name) for z, (apart, name) in zip(seen, near, strict=True))


def _keep(
    path: Path, known: Visible, cases: Sequence[Case], found: Iterable[tuple[Visibility, ...]]
) -> None:
    with path.open("a", encoding="utf-8") as file:
        for case, each in zip(cases, found, strict=True):
            known[case.number] = each
            plain = [(z, apart if math.isfinite(apart) else None, name) for z, apart, name in each]
            file.write(json.dumps({"number": case.number, "visible": plain}) + "\n")
            file.flush()


def _read(path: Path) -> Visible:
    known: Visible = {}
    for text in path.read_text("utf-8").splitlines() if path.exists() else ():
        try:
            line = json.loads(text)
        except ValueError:  # cut off: worked out again
            continue
        known[line["number"]] = tuple(
            (z, math.inf if apart is None else apart, name) for z, apart, name in line["visible"]
        )
    return known
