"""Running a diagnosis over the cases: one line per finished case, to be resumed at any time.

A run's folder holds `run.json` (what is run, and the commitment to all of it), `commitments.jsonl`
(of each answer, before its recording is diagnosed), `answers/` (sealed), `diagnoses.jsonl` (what
the diagnosis said), and `key.hex`. The diagnosis is handed a folder that lies elsewhere, under a
name of chance, and nothing but that.
"""

import json
import secrets
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict
from importlib import import_module
from pathlib import Path
from typing import Any

from tests.concealed.generator.answer import take_case
from tests.concealed.generator.case import Case
from tests.concealed.generator.folder import write_folder
from tests.concealed.generator.seal import KEY_BYTES, canonical, commitment, sealed

Diagnose = Callable[[Path], dict[str, Any]]
"""A recording's folder in, what `diagnose --json` answers out."""


def run(cases: Sequence[Case], diagnose: str, out: Path, *, workers: int = 1) -> None:
    """Diagnose every case of which `out` has no line yet.

    Args:
        cases: Of one suite; a folder begun with another one is refused.
        diagnose: "module:function", imported in each worker.
        out: The run's folder.
        workers: Processes.
    """
    key = _begin(cases, diagnose, out)
    done = finished(out)
    waiting = [case for case in cases if case.number not in done]
    for line in _outcomes(waiting, diagnose, out, key, workers):
        _append(out / "diagnoses.jsonl", line)
        print(f"{len(finished(out))}/{len(cases)}", file=sys.stderr, flush=True)


def finished(out: Path) -> dict[int, dict[str, Any]]:
    """Return what was diagnosed, by number; a line that was cut off is done again."""
    done = {}
    path = out / "diagnoses.jsonl"
    for text in path.read_text("utf-8").splitlines() if path.exists() else ():
        try:
            line = json.loads(text)
        except ValueError:
            continue
        done[int(line["number"])] = line
    return done


def _begin(cases: Sequence[Case], diagnose: str, out: Path) -> bytes:
    (out / "answers").mkdir(parents=True, exist_ok=True)
    if not (out / "key.hex").exists():
        (out / "key.hex").write_text(secrets.token_hex(KEY_BYTES), "utf-8")
    key = bytes.fromhex((out / "key.hex").read_text("utf-8"))
    digest = commitment(key, canonical([asdict(case) for case in cases]))
    content = {"cases": len(cases), "diagnose": diagnose, "commitment": digest}
    before = out / "run.json"
    if before.exists() and json.loads(before.read_text("utf-8")) != content:
        raise ValueError(f"{out} holds another run: give a new folder, or the same run's arguments")
    before.write_text(json.dumps(content), "utf-8")
    print(f"commitment to all {len(cases)} cases: {digest}", flush=True)
    return key


def _outcomes(
    cases: Sequence[Case], diagnose: str, out: Path, key: bytes, workers: int
) -> Iterator[dict[str, Any]]:
    if workers == 1:
        yield from (diagnose_case(case, diagnose, out, key) for case in cases)
        return
    with ProcessPoolExecutor(workers) as pool:
        jobs = [pool.submit(diagnose_case, case, diagnose, out, key) for case in cases]
        for job in as_completed(jobs):
            yield job.result()


def diagnose_case(case: Case, diagnose: str, out: Path, key: bytes) -> dict[str, Any]:
    """Draw the case, seal its answer, diagnose it; a diagnosis that fails is a line, too."""
    taken, answer = take_case(case)
    content, digest = sealed(answer, key)
    (out / "answers" / f"{case.number:05d}.sealed").write_bytes(content)
    _append(out / "commitments.jsonl", {"number": case.number, "sha256": digest})
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / secrets.token_hex(6)
        setting = case.setting
        write_folder(folder, setting.sensor, setting.plan, taken, case.rng("instruments"))
        began = time.perf_counter()
        try:
            said: dict[str, Any] = {"said": named_function(diagnose)(folder)}
        except Exception as error:
            said = {"error": f"{type(error).__name__}: {error}"}
        seconds = time.perf_counter() - began
    return {"number": case.number, "sha256": digest, "seconds": round(seconds, 3), **said}


def named_function(name: str) -> Diagnose:
    """Return the function that "module:function" names."""
    module, _, function = name.partition(":")
    found: Diagnose = getattr(import_module(module), function)
    return found


def _append(path: Path, line: dict[str, Any]) -> None:
    text = json.dumps(line, allow_nan=False)
    torn = path.exists() and not path.read_bytes().endswith(b"\n")
    with path.open("a", encoding="utf-8") as file:
        file.write(("\n" if torn else "") + text + "\n")
