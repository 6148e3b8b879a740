"""First lines of sensors whose taps do not all read each row."""

import numpy as np
from numpy.random import default_rng
from scipy.stats import chi2

from calib.diagnosis.signatures.changes import change_of
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.forward.effects.lag import Lag
from calib.recording.header import Block
from tests.calib.diagnosis.recordings import plain_model, recorded

LAG = Lag(0.004)


def test_a_step_of_light_leaves_in_quadrants_what_lag_says() -> None:
    rows = [("flat", 900.0, 3.0), ("dark", 900.0, 0.0), ("flat", 900.0, 1.0), ("flat", 300.0, 3.0)]
    blocks = [
        Block(block=str(k), kind=kind, exposure_us=exposure, level=level, lines=40)
        for k, (kind, exposure, level) in enumerate(rows)
    ]
    model = plain_model(96, rows=8, taps=4, layout="quadrants")
    evidence = recorded(model, blocks, default_rng(), (LAG,))
    seen = evidence.observed().onset
    told = change_of((LAG,), evidence, responder_of(evidence)).onset
    z = ((seen - told) / evidence.onset_std)[1:]
    # Of whole lines, not of taps: by chance once in 100,000 runs.
    assert (z**2).sum() < chi2.isf(1e-5, z.size)
    assert np.abs(told / evidence.onset_std).max() > 30.0
