import numpy as np
import pytest
from numpy.random import default_rng

from calib.diagnosis.evidence import Evidence
from calib.forward.model import Model
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

SENSORS = {
    "line": lambda: plain_model(128),
    "odd and even": lambda: plain_model(128, taps=2, layout="odd_even"),
    "quarters": lambda: plain_model(128, bits=14, taps=4, layout="quarters"),
}


def evidence_of_clean(model: Model) -> list[Evidence]:
    return [recorded(model, plan(rng, 60), rng) for rng in default_rng().spawn(4)]


@pytest.mark.parametrize("sensor", SENSORS)
def test_what_the_baseline_expects_is_what_clean_recordings_show(sensor: str) -> None:
    """Each statistic's z has mean 0 and standard deviation 1, pooled over blocks and recordings."""
    many = evidence_of_clean(SENSORS[sensor]())
    for kind in many[0].places:
        z = []
        for evidence in many:
            std = evidence.pooled_std[:, evidence.places[kind]]
            observed = evidence.observed().pooled[:, evidence.places[kind]]
            fine = np.isfinite(std) & (std > 0)
            z.append(observed[fine] / std[fine])
        pooled = np.concatenate(z)
        if len(pooled) == 0:
            continue
        # Twelve kinds on three sensors: 5 standard errors are exceeded once in 30,000 runs. Chi-
        # squared statistics of line means are skewed, and gain and read noise were fitted.
        assert abs(pooled.mean()) < 5.0 / np.sqrt(len(pooled)), kind
        assert abs(pooled.std() - 1.0) < 5.0 / np.sqrt(2 * len(pooled)) + 0.07, kind


def test_means_scatter_as_much_as_their_weights_say() -> None:
    for evidence in evidence_of_clean(plain_model(128)):
        point = evidence.point(evidence.observed())
        freedom = evidence.space.degrees_of_freedom
        assert abs(float((point.means**2).sum()) - freedom) < 5.0 * np.sqrt(2.0 * freedom)
