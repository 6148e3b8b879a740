"""Measures fitted parameters against what was simulated, each effect looked for by itself.

python -m tests.calib.diagnosis.coverage runs effect ...
"""

import sys

import numpy as np
from numpy.random import default_rng

from calib.diagnosis.answer.found import estimates_of
from calib.diagnosis.given.known import beside
from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.search import find
from calib.diagnosis.shapes.of_effects import shapes_of
from calib.diagnosis.shapes.told_shapes import told_shapes
from calib.diagnosis.signatures.looked_for import scales_of
from calib.diagnosis.signatures.signature import signature
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.forward.effects.catalogue import effect_named
from tests.calib.diagnosis.recordings import plain_model, plan, recorded
from tests.calib.diagnosis.trial import CASES, effects_of


def errors_of(name: str, values: dict[str, object] | None = None) -> dict[str, tuple[float, float]]:
    """Return each parameter's error and standard uncertainty in one run, relative to the truth."""
    values, rng = values or dict(CASES)[name], default_rng()
    taps = name in {"tap_crosstalk", "tap_gain_drift"}
    model = plain_model(taps=2, layout="odd_even") if taps else plain_model()
    evidence = recorded(model, plan(rng), rng, effects_of(name, values, int(rng.integers(99))))
    responder = responder_of(evidence)
    shapes = told_shapes(evidence).get(name)
    if shapes is None:
        shapes = shapes_of(effect_named(name), scales_of(evidence, responder))
    signatures = [signature(shape, evidence, responder) for shape in shapes]
    contest = Contest(tuple(s for s in signatures if s is not None), evidence, responder)
    found = find(contest, beside(None, evidence))
    errors = {}
    for member in found.members:
        for key, estimate in estimates_of(member).items():
            truth = values.get(key)
            if isinstance(truth, float) and truth and estimate.std > 0:
                errors[key] = (estimate.value / truth - 1.0, estimate.std / abs(truth))
    return errors


def main() -> None:
    """Print a line per parameter: how often it was fitted, z, error and standard uncertainty."""
    runs = int(sys.argv[1])
    for name in sys.argv[2:]:
        every = [errors_of(name) for _ in range(runs)]
        for key in sorted({key for each in every for key in each}):
            error, std = np.array([each[key] for each in every if key in each]).T
            z = error / std
            print(
                f"{name:24s} {key:18s} n {len(z):3d}  z {z.mean():5.2f} +- {z.std():4.2f}  "
                f"error {100 * error.mean():5.1f} %  std {100 * std.mean():5.1f} %",
                flush=True,
            )


if __name__ == "__main__":
    main()
