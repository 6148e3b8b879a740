"""A store with something to look at: a recording, two coefficient sets, jobs that are done."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import default_rng

from calib.mtf.answer import answer
from calib.mtf.edge.edge_result import EdgeResult, EdgeView
from calib.mtf.geometry import Alignment
from calib.mtf.measure import measure
from calib.mtf.result import TransferResult
from calib.mtf.simulation.detector import DetectorNoise
from calib.mtf.simulation.edge import edge_image, noisy
from calib.radiometric.calibrate import calibrate
from calib.recording.open import open_recording
from service.api.jobs.files import JobFiles
from service.settings import Settings
from service.store.actor import Actor
from service.store.store import Store
from tests.calib.mtf.simulated import CORNER, ORDERS_12, PITCH_UM, SMALL, record

BY = Actor("ada")
DIAGNOSIS: dict[str, Any] = {
    "verdict": "explained",
    "findings": [
        {
            "effect": "brighter_fatter",
            "probability": 0.97,
            "candidates": [
                {"effect": "brighter_fatter", "probability": 0.97},
                {"effect": "interpixel_capacitance", "probability": 0.03},
            ],
            "significance_sigma": 14.2,
            "where": {"text": "neighbouring columns vary together, more where they are bright"},
            "physics": "charge that has been collected pushes later charge to its neighbours",
            "parameters": {"a": {"value": 1.9e-6, "std": 1.2e-7, "unit": "1/e-"}},
            "heldout_deviance_before": 1824.0,
            "heldout_deviance_after": 1562.0,
            "fraction_explained": 0.93,
        }
    ],
    "unexplained": None,
    "next_measurement": None,
}


def fill_store(
    home: Path, recording: Path, *, name: str = "six flats", notes: int = 0
) -> tuple[str, str]:
    """Fill the store of `home`; return the digest of its recording and a set's id.

    The log gets `notes` entries beside.
    """
    opened = open_recording(recording)
    settings = Settings(home=home)
    home.mkdir(parents=True, exist_ok=True)
    with Store.open(settings) as store:
        kept = store.recordings.register(opened, name=name, by=BY)
        sets = [
            store.sets.add(calibrate(opened, order=order).coefficients, by=BY, reason="calibrated")
            for order in (2, 4)
        ]
        _finish(store, "diagnose", {"recording": kept.digest}, DIAGNOSIS)
        for result in (_edge(), _grating()):
            made = home / "made"
            made.mkdir()
            result.save(made / "transfer-function.h5")
            told = result.answer() if isinstance(result, EdgeResult) else answer(result)
            job = _finish(store, "transfer-function", {"method": told["method"]}, told)
            JobFiles(settings.jobs_folder).keep(job, made)
        for number in range(notes):
            store.audit.record(BY, "note", str(number))
    return kept.digest, sets[-1].id


def _finish(store: Store, kind: str, request: dict[str, Any], result: dict[str, Any]) -> str:
    """Put a job on record that has succeeded; return its id."""
    job = store.jobs.submit(kind, request, max_waiting=9)
    store.jobs.start(job.id)
    store.jobs.finish(job.id, "succeeded", result=result)
    return job.id


def _grating() -> TransferResult:
    """Return the transfer function that a small scan shows."""
    case = record(
        default_rng(), (40, 40), scan=SMALL, grating=ORDERS_12,
        alignment=Alignment(np.array([11.0, -23.0])),
        detector=DetectorNoise(shot_noise=True, averaged=100),
    )  # fmt: skip
    return TransferResult(measure(case.scan))


def _edge() -> EdgeResult:
    """Return the transfer function that a slanted edge shows."""
    light = edge_image(CORNER, PITCH_UM, (200, 60), 0.0933)
    noise = DetectorNoise(read_noise_e=300.0, shot_noise=True)
    return EdgeResult(noisy(light, noise, default_rng()), EdgeView(PITCH_UM))
