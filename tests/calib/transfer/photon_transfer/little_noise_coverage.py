"""Do K and read noise of 8-bit cameras lie as far from the truth as their errors say?

python -m tests.calib.transfer.photon_transfer.little_noise_coverage [--recordings 200]
"""

import argparse
import sys
from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray

from calib.recording.statistics import column_statistics
from calib.transfer.photon_transfer.measure import gain_and_noise, photon_transfer
from calib.transfer.photon_transfer.result import PhotonTransfer
from tests.calib.transfer.photon_transfer.little_noise import EightBits
from tests.calib.transfer.photon_transfer.simulated import Held


def by_columns(held: Held) -> PhotonTransfer:
    return gain_and_noise(column_statistics(held), held.header.camera)


WAYS: dict[str, Callable[[Held], PhotonTransfer]] = {
    "pairs": photon_transfer,
    "columns": by_columns,
}


def scores(camera: EightBits, way: str, seeds: Iterable[int]) -> NDArray[np.float64]:
    """z of K, of the read noise in DN and in electrons, (n, 3)."""
    return np.array([score(camera, WAYS[way](drawn(camera, seed))) for seed in seeds])


def drawn(camera: EightBits, seed: int) -> Held:
    return camera.recording(np.random.default_rng([seed, round(1e3 * camera.read_dn)]))


def score(camera: EightBits, found: PhotonTransfer) -> list[float]:
    pairs = (
        (found.system_gain, camera.gain),
        (found.read_noise_dn, camera.read_dn),
        (found.read_noise_e, camera.read_dn / camera.gain),
    )
    return [(estimate.value - truth) / estimate.std for estimate, truth in pairs]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--recordings", type=int, default=200)
    parser.add_argument("--sigmas", type=float, nargs="*", default=[0.12, 0.17, 0.25, 0.3, 0.5, 1])
    chosen = parser.parse_args()
    for sigma in chosen.sigmas:
        camera = EightBits(sigma)
        for way in WAYS:
            z = scores(camera, way, range(chosen.recordings))
            numbers = " | ".join(
                f"{m:+.2f}, {s:.2f}"
                for m, s in zip(z.mean(axis=0), z.std(axis=0, ddof=1), strict=True)
            )
            sys.stdout.write(f"| {sigma} | {way} | {numbers} |\n")
            sys.stdout.flush()


if __name__ == "__main__":
    main()
