"""Do estimates lie as far from the truth as their standard errors say? In the long form

python -m tests.calib.transfer.photon_transfer.coverage [--recordings 400]
"""

import argparse
import sys
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from calib.transfer.estimate import Estimate
from calib.transfer.photon_transfer.curve_fit import Model
from calib.transfer.photon_transfer.measure import photon_transfer
from tests.calib.transfer.photon_transfer.simulated import GAIN, READ_DN, Kind, recording

KINDS: tuple[Kind, ...] = ("straight", "nonlinear", "brighter_fatter")
COLUMNS = 256


def scores(
    kind: Kind, lines: int, seeds: Iterable[int], columns: int = COLUMNS
) -> tuple[NDArray[np.float64], list[str]]:
    """z of K, of the read noise in DN and in electrons, and of the K of a straight line that is
    fitted to everything, (n, 4), and the models called for."""
    found, models = [], []
    for seed in seeds:
        rng = np.random.default_rng([seed, lines, columns])
        measured = photon_transfer(recording(kind, lines, columns, rng))
        pairs: tuple[tuple[Estimate, float], ...] = (
            (measured.system_gain, GAIN),
            (measured.read_noise_dn, READ_DN),
            (measured.read_noise_e, READ_DN / GAIN),
        )
        line = measured.taps[0].choice.fits[Model.STRAIGHT]
        pairs += ((Estimate(line.shape.system_gain, line.std("system_gain"), "DN/e-"), GAIN),)
        found.append([(estimate.value - truth) / estimate.std for estimate, truth in pairs])
        models.append(measured.model)
    return np.array(found), models


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--recordings", type=int, default=400)
    parser.add_argument("--lines", type=int, nargs="*", default=[20, 100, 500])
    chosen = parser.parse_args()
    for lines in chosen.lines:
        for kind in KINDS:
            z, models = scores(kind, lines, range(chosen.recordings))
            numbers = " | ".join(
                f"{m:+.2f} {s:.2f}"
                for m, s in zip(z.mean(axis=0), z.std(axis=0, ddof=1), strict=True)
            )
            counts = ", ".join(f"{models.count(m)} {m}" for m in sorted(set(models)))
            sys.stdout.write(f"| {lines} | {kind} | {numbers} | {counts} |\n")
            sys.stdout.flush()


if __name__ == "__main__":
    main()
