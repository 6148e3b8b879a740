"""A store with something to look at: a recording, two coefficient sets, a diagnosis."""

from pathlib import Path
from typing import Any

from calib.radiometric.calibrate import calibrate
from calib.recording.open import open_recording
from service.settings import Settings
from service.store.actor import Actor
from service.store.store import Store

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


def fill_store(home: Path, recording: Path, *, notes: int = 0) -> tuple[str, str]:
    """Fill the store of `home`; return the digest of its recording and a set's id.

    The log gets `notes` entries beside.
    """
    opened = open_recording(recording)
    settings = Settings(home=home)
    home.mkdir(parents=True, exist_ok=True)
    with Store.open(settings) as store:
        kept = store.recordings.register(opened, name="six flats", by=BY)
        sets = [
            store.sets.add(calibrate(opened, order=order).coefficients, by=BY, reason="calibrated")
            for order in (2, 4)
        ]
        job = store.jobs.submit("diagnose", {"recording": kept.digest}, max_waiting=9)
        store.jobs.start(job.id)
        store.jobs.finish(job.id, "succeeded", result=DIAGNOSIS)
        for number in range(notes):
            store.audit.record(BY, "note", str(number))
    return kept.digest, sets[-1].id
