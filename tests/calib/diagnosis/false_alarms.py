"""Measures what chance reaches: the highest score and the worst remainder of clean recordings.

python -m tests.calib.diagnosis.false_alarms [runs]
"""

import sys
from collections.abc import Callable
from secrets import randbits

import numpy as np
from numpy.random import default_rng

from calib.diagnosis.given.known import beside
from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.remainder import worst
from calib.diagnosis.signatures.looked_for import signatures_of
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.forward.model import Model as ForwardModel
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

SENSORS: dict[str, Callable[[], ForwardModel]] = {
    "line 12 bit": plain_model,
    "line 10 bit, 2 taps": lambda: plain_model(bits=10, taps=2, layout="odd_even"),
    "line 14 bit, 4 taps": lambda: plain_model(bits=14, taps=4, layout="quarters"),
    "line 8 bit": lambda: plain_model(bits=8),
    "area 12 bit": lambda: plain_model(64, rows=48),
}


def main() -> None:
    """Print a line per recording: sensor, best name and its score, worst remainder."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 10
    entropy = randbits(32)
    print(f"entropy {entropy}")
    for run in range(runs):
        name = list(SENSORS)[run % len(SENSORS)]
        rng = default_rng([entropy, run])
        model = SENSORS[name]()
        evidence = recorded(model, plan(rng, 12 if model.camera.rows else 100), rng)
        responder = responder_of(evidence)
        signatures = signatures_of(evidence, responder)
        nothing = beside(None, evidence)
        best = Contest(signatures, evidence, responder).ranking(nothing, worth=8.0)[0]
        look, sigma = worst(nothing, evidence)
        chi2 = (nothing.first.means**2).sum() / evidence.space.degrees_of_freedom
        print(
            f"{name:20s} {best.signature.shape.name:24s} {best.net:7.1f} {look.statistic:18s} "
            f"{sigma:5.1f}  chi2/dof {chi2:.3f} common {np.sqrt(evidence.common.fixed_dn2):.3f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
