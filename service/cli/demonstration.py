"""The whole way on a simulated bench: sweep, calibrate, apply, diagnose, report."""

import shutil
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from calib.arrays import Columns
from calib.errors import DarkflatError
from calib.forward.effects.interpixel_capacitance import InterpixelCapacitance
from calib.forward.model import Model
from calib.radiometric.calibrate import calibrate
from calib.radiometric.calibration import Calibration
from calib.radiometric.correction.apply import Correction
from calib.radiometric.correction.apply_options import ApplyOptions
from calib.radiometric.correction.apply_recording import correct_recording
from calib.recording.open import open_recording
from calib.recording.protocol import Recording
from service.bench import BenchSettings, open_bench
from service.cli.demo_diagnosis import sentences_of, shortened, take_diagnosis
from service.cli.demo_plan import demo_plan
from service.cli.progress import Report
from service.cli.reporting import write_calibration_report
from service.cli.simulated_bench import LAMPS, MODEL, ChosenBench
from service.cli.stopping import polled, stop_wanted
from service.cli.sweep_progress import sweep_progress
from service.plan.model import Plan
from service.sequencer.events import RunResult
from service.sequencer.run import run_plan

_MADE = (
    "plan.toml", "recording.h5", "recording.frames.jsonl", "coefficient-set.h5", "radiance.h5",
    "report.html", "bench-model.toml", "diagnosis.html", "amended-model.toml",
)  # fmt: skip


HIDDEN = InterpixelCapacitance(column_coupling=0.012)
"""What the demonstration's camera does beyond the plain model: a diagnosis has to find it."""


@dataclass(frozen=True)
class Demonstration:
    """What was made, and what there is to show.

    Attributes:
        answer: For `--json`.
        calibration: With all its figures.
        raw_dn: Mean raw line of the block that was judged, (n_columns,).
        radiance: The same, corrected; NaN where masked.
    """

    answer: dict[str, Any]
    calibration: Calibration
    raw_dn: Columns
    radiance: Columns


def demonstrate(bench: ChosenBench, out: Path, report: Report) -> Demonstration:
    """Do it all into the folder `out`; `report` is told the share that is done."""
    began = time.monotonic()
    _make_room(out)
    plan = demo_plan(Model.preset(MODEL), lamps=LAMPS)
    (out / "plan.toml").write_text(plan.dumps(), encoding="utf-8")
    result = _sweep(_hiding(bench.settings, out), plan, out / "recording.h5", report)
    recording = open_recording(result.path)
    report(0.74, "calibrating")
    calibration = calibrate(recording, plan=plan.dumps())
    calibration.coefficients.save(out / "coefficient-set.h5")
    report(0.8, "correcting")
    judged = calibration.uniformity.block if calibration.uniformity else None
    correct_recording(
        recording,
        calibration.coefficients,
        out / "radiance.h5",
        options=ApplyOptions(blocks=[judged] if judged else None),
        cancelled=stop_wanted,
    )
    report(0.85, "diagnosing")
    diagnosis = take_diagnosis(recording, out)
    report(0.97, "drawing the report")
    write_calibration_report(
        out / "report.html", recording, calibration, remarks=sentences_of(diagnosis)
    )
    raw_dn, radiance = _profiles(
        recording, calibration, judged or recording.header.blocks[-1].block
    )
    answer = {
        **_told(bench, result, calibration, out),
        "diagnosis": shortened(diagnosis, out),
        "seconds": round(time.monotonic() - began, 2),
    }
    return Demonstration(answer, calibration, raw_dn, radiance)


def _told(
    bench: ChosenBench, result: RunResult, calibration: Calibration, out: Path
) -> dict[str, Any]:
    """Return the answer but for the diagnosis and the time."""
    told = calibration.answer()
    return {
        **_transports(bench.settings),
        "frames": result.frames,
        "lost_frames": result.lost_frames,
        "recording": str(result.path),
        "coefficient_set": calibration.coefficients.id,
        "cov_before_percent": told["cov_before_percent"],
        "cov_after_percent": told["cov_after_percent"],
        "report": str(out / "report.html"),
        "radiance": str(out / "radiance.h5"),
        "remark": bench.remark,
        "warnings": told["warnings"],
    }


def _hiding(settings: BenchSettings, out: Path) -> BenchSettings:
    """Return the bench with a camera that does something of which nobody told the calibration."""
    path = out / "bench-model.toml"
    Model.preset(MODEL).with_effect(HIDDEN).save(path)
    assert settings.simulation is not None  # noqa: S101 - the demonstration has a simulated bench
    simulation = settings.simulation.model_copy(update={"model": str(path.resolve())})
    return settings.model_copy(update={"simulation": simulation})


def _make_room(out: Path) -> None:
    """Make the folder; of one that is there, take away what an earlier demonstration left."""
    if out.exists() and not out.is_dir():
        msg = f"{out} is not a folder; give another --out"
        raise DarkflatError(msg, code="output-exists")
    out.mkdir(parents=True, exist_ok=True)
    strange = {each.name for each in out.iterdir()} - set(_MADE)
    if strange and not (out / "plan.toml").exists():
        msg = f"{out} holds something else ({min(strange)}); give an empty or new folder as --out"
        raise DarkflatError(msg, code="output-exists")
    for name in _MADE:
        path = out / name
        shutil.rmtree(path) if path.is_dir() else path.unlink(missing_ok=True)


def _sweep(settings: BenchSettings, plan: Plan, out: Path, report: Report) -> RunResult:
    report(0.0, "starting the simulated bench")
    with open_bench(settings) as bench, polled():
        result = run_plan(
            bench,
            plan,
            out,
            cancelled=stop_wanted,
            on_progress=sweep_progress(report, first=0.05, last=0.74),
        )
    if result.state != "succeeded":
        raise DarkflatError("stopped in the middle of the sweep, lamps off", code="cancelled")
    return result


def _transports(settings: BenchSettings) -> dict[str, str]:
    """Say what the pixels and the commands really went through."""
    gige, ptys = settings.needs_simulated_camera, settings.needs_emulators
    return {
        "transport": "gige-vision" if gige else "in-process",
        "serial": "pseudo-terminal" if ptys else "in-process",
    }


def _profiles(
    recording: Recording, calibration: Calibration, block: str
) -> tuple[Columns, Columns]:
    """Return the mean line of `block`, raw and corrected."""
    dn = np.concatenate(list(recording.frames(block)))
    conditions = next(each for each in recording.header.blocks if each.block == block)
    correction = Correction(
        calibration.coefficients, conditions.exposure_us, camera=recording.header.camera
    )
    return dn.mean(axis=0), correction.mean_line(dn).radiance[0].astype(np.float64)
