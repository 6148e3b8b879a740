"""Crosstalk of noise: strong as it is, and without what rounding adds behind it."""

import numpy as np
from numpy.random import default_rng

from calib.diagnosis.signatures.changes import change_of
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.forward.effects.tap_crosstalk import TapCrosstalk
from tests.calib.diagnosis.coverage import errors_of
from tests.calib.diagnosis.recordings import plain_model, plan, recorded


def test_strong_crosstalk_is_measured_to_one_percent() -> None:
    # It was 12 % too strong when a fit ended before the baseline had followed.
    every = [errors_of("tap_crosstalk", {"fraction": 0.2})["fraction"] for _ in range(2)]
    error, std = np.mean(every, axis=0)
    assert abs(error) < 0.01 + 4.0 * std / np.sqrt(2.0)


def test_partners_share_the_noise_that_is_converted_and_not_its_rounding() -> None:
    rng, x = default_rng(), 0.05
    # 0.6 DN of read noise: of the variance of codes rounding makes a fifth.
    model = plain_model(128, bits=8, taps=2, layout="odd_even")
    evidence = recorded(model, plan(rng, 60, twice=0), rng)
    moved = change_of((TapCrosstalk(x, "odd_even"),), evidence, responder_of(evidence)).pooled
    base = evidence.baseline
    # Every other pair of neighbours are partners. With rounding they would share a fifth more;
    # in the few lines that are drawn, chance products with it make 4 %.
    expected = x * (base.read_variance_dn2.mean() - 1.0 / 12.0)
    shared = moved[evidence.table.dark][:, evidence.pooled.places["columns_1"]].mean()
    assert abs(shared / expected - 1.0) < 0.1
