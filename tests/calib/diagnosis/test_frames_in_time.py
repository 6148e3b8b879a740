"""What a frame has in common with the next one: jitter has none of it, a slow flicker most."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.random import Generator, default_rng
from scipy.stats import chi2

from calib.diagnosis.diagnose import examine
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.signatures.changes import change_of
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.diagnosis.statistics.pooled import settled
from calib.forward.effect import Effect
from calib.forward.effects.exposure_jitter import ExposureJitter
from calib.forward.effects.lamp_flicker import LampFlicker
from calib.recording.header import Block
from tests.calib.diagnosis.recordings import plain_model, recorded

FRAMES, TO_THE_NEXT_US = 40, 10_400.0
"""A flicker of 100 Hz turns by 1.04 from frame to frame: seen to turn twice, it is no tone."""


def frames(*effects: Effect) -> Evidence:
    rng, model = default_rng(), plain_model(32, rows=12)
    camera = model.camera.model_copy(update={"line_period_us": TO_THE_NEXT_US})
    return recorded(replace(model, camera=camera), blocks(rng), rng, effects)


def blocks(rng: Generator) -> list[Block]:
    wanted = [(t, level) for t in (150.0, 300.0, 600.0, 1000.0) for level in (0.0, 2.0, 3.0)]
    return [
        Block(
            block=f"{k:03d}", kind="flat" if level else "dark", exposure_us=t, level=level,
            lines=FRAMES,
        )
        for k, (t, level) in enumerate(rng.permutation(wanted).tolist())
    ]  # fmt: skip


def in_time(evidence: Evidence, pooled: np.ndarray) -> np.ndarray:
    return np.asarray(pooled[:, evidence.pooled.places["common_2"]][:, 0])


def test_frames_that_share_nothing_scatter_as_expected() -> None:
    z = []
    for _ in range(4):
        evidence = frames()
        z.append(in_time(evidence, evidence.pooled.over_std(evidence.pooled.observed)))
    # Sums of products have longer tails than normal numbers: once in 1e5 runs stands for 1e-3.
    every = np.concatenate(z)
    assert chi2.ppf(1e-5, every.size) < (every**2).sum() < chi2.isf(1e-5, every.size)
    assert abs(every.mean()) < 4.0 / np.sqrt(every.size)


@pytest.mark.parametrize(
    ("effect", "name"),
    [
        (ExposureJitter(0.002), "exposure_jitter"),
        (ExposureJitter(0.0005, "time"), "exposure_jitter"),
        (LampFlicker(0.003), "lamp_flicker"),
    ],
)
def test_each_is_named(effect: Effect, name: str) -> None:
    named = ([f.effect.name for f in examine(frames(effect)).diagnosis.findings] for _ in range(2))
    # One in some forty such recordings is left unexplained, or has a second name.
    assert [name] in named


def test_few_frames_that_are_simulated_stand_for_all() -> None:
    evidence = frames()
    found = change_of((ExposureJitter(0.002),), evidence, responder_of(evidence)).pooled
    shared = found[:, evidence.pooled.places["common_1"]][:, 0]
    bright = shared > 0.3 * shared.max()
    # Residuals of white noise about their mean covary by -1/n of what they share.
    wanted = -shared[bright] / settled(FRAMES)
    scatter = shared[bright] / np.sqrt(FRAMES)
    assert np.abs(in_time(evidence, found)[bright] - wanted).max() < scatter.max()
