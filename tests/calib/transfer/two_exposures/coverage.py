"""The tables of docs/photon-transfer/two-exposures.md: spread of z, pooled and pixel by pixel.

python -m tests.calib.transfer.two_exposures.coverage [--recordings 1000]
"""

import argparse
import sys

import numpy as np

from calib.transfer.two_exposures.sanuc import sanuc
from tests.calib.transfer.two_exposures.scores import spread_of
from tests.calib.transfer.two_exposures.stacks import Sensor, drawn_pair
from tests.calib.transfer.two_exposures.test_pooled import (
    NAMES,
    Draw,
    flickering,
    jumping,
    plain,
    z_scores,
)

FRAMES = (20, 100, 500)
LIT = ((10_000.0, 10.0), (150.0, 6.0))
DRAWS: dict[str, Draw] = {
    "": plain,
    ", flicker of 0.3 %": flickering,
    ", offsets of 15 DN": jumping,
}
PIXELS = 20_000


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--recordings", type=int, default=1000)
    times = parser.parse_args().recordings
    write = sys.stdout.write
    for electrons, read_e in LIT:
        sensor = Sensor.flat(400, electrons, read_e, gain=0.8, spread=0.02)
        for words, draw in DRAWS.items():
            for n in FRAMES:
                z = z_scores(sensor, n, times, draw, seed=99)
                cells = [f"{each.mean():+.2f}, {spread_of(each)[0]:.3f}" for each in z.T]
                write(f"| {electrons:g} e⁻, {read_e:g} e⁻{words} | {n} | {' | '.join(cells)} |\n")
    for electrons, read_e in (*LIT, (1000.0, 10.0)):
        sensor = Sensor.flat(PIXELS, electrons, read_e, gain=0.8, spread=0.02)
        for n in (20, 50, 100, 200, 500):
            write(f"| {electrons:g} e⁻, {read_e:g} e⁻ | {n} | {per_pixel(sensor, n)} |\n")


def per_pixel(sensor: Sensor, n: int) -> str:
    """Return one row: share of pixels told, mean and spread of z, bias before and after."""
    pair = drawn_pair(sensor, n, key=n)
    maps = sanuc(pair)
    true = (sensor.gain, sensor.bias, sensor.electrons, sensor.read_noise_dn2)
    cells = []
    for name, value in zip(NAMES, true, strict=True):
        z = (getattr(maps, name) - value) / getattr(maps, name + "_std")
        z = z[np.isfinite(z)]
        cells.append(f"{z.mean():+.2f}, {spread_of(z)[0]:.3f}")
    known = np.isfinite(maps.photoelectrons)
    d, v = pair.difference_dn[known], pair.variance_difference_dn2[known]
    told = (d**2 / v, maps.photoelectrons[known])
    off = [f"{100 * (np.mean(each / sensor.electrons[known]) - 1):+.1f} %" for each in told]
    return " | ".join([f"{100 * known.mean():.1f} %", *cells, *off])


if __name__ == "__main__":
    main()
