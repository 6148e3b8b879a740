"""The simulation of Yielding, Cain and Seal (2018) again: their Figures 1 to 3, S3NUC and SANUC.

    python examples/two_exposures.py [--out docs/gallery]

100 x 100 pixels with G ~ N(1, 0.05), B ~ N(100, 1), noise 10 DN, the second exposure of twice as
many photo-electrons, 1 to 500 frames in steps of 10. The paper does not print the number of
photo-electrons, so that it is swept. What is printed is a Markdown table, for
docs/photon-transfer/two-exposures.md.
"""

import argparse
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from calib.kernels.pixel_moments import PixelAccumulator
from calib.report import style
from calib.transfer.two_exposures.exposure_pair import ExposureMoments, ExposurePair
from calib.transfer.two_exposures.pixel_maps import PixelMaps
from calib.transfer.two_exposures.s3nuc import s3nuc
from calib.transfer.two_exposures.sanuc import sanuc

PIXELS = 100 * 100
FULL_SCALE_DN = 65535
STEP, LAST, JUDGED_AT = 10, 491, 100
PHOTOELECTRONS = (50, 100, 300, 1000, 10_000)
OPEN = {"S3NUC": "white", "SANUC": style.BLUE}
METHODS = {"S3NUC": (s3nuc, style.ORANGE), "SANUC": (sanuc, style.BLUE)}


@dataclass(frozen=True)
class Shown:
    """A quantity and the figure that shows it."""

    map_name: str
    file: str
    title: str


QUANTITIES = (
    Shown("system_gain_dn_per_e", "sanuc-fig1-gain", "Gain"),
    Shown("bias_dn", "sanuc-fig2-bias", "Bias"),
    Shown("read_noise_variance_dn2", "sanuc-fig3-read-noise", "Read noise variance"),
)


@dataclass(frozen=True)
class Sensor:
    """The simulated pixels: what the estimates should be, by the name of the map."""

    truth: dict[str, NDArray[np.float64]]

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> "Sensor":
        """Draw gains and biases."""
        gain, bias = rng.normal(1.0, 0.05, PIXELS), rng.normal(100.0, 1.0, PIXELS)
        noise = np.full(PIXELS, 100.0)
        names = (quantity.map_name for quantity in QUANTITIES)
        return cls(dict(zip(names, (gain, bias, noise), strict=True)))

    def frames(self, electrons: float, n: int, rng: np.random.Generator) -> NDArray[np.uint16]:
        """Return n frames, Eq. 1 of the paper, rounded to codes."""
        gain, bias, _ = self.truth.values()
        dn = gain * rng.poisson(electrons, (n, PIXELS)) + bias
        dn += 10.0 * rng.standard_normal((n, PIXELS))
        return np.clip(np.rint(dn), 0, FULL_SCALE_DN).astype(np.uint16)


Errors = dict[tuple[str, str], list[tuple[int, float, float]]]
"""(frames, mean, standard deviation over the pixels) by method and quantity."""


def main() -> None:
    """Simulate, draw and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("docs/gallery"))
    folder = parser.parse_args().out
    folder.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(2018)
    sensor = Sensor.drawn(rng)
    swept: dict[float, Errors] = {}
    rows: list[str] = []
    for electrons in PHOTOELECTRONS:
        errors: Errors = {}
        for n, pair in recorded(sensor, electrons, rng):
            maps = {name: estimate(pair) for name, (estimate, _) in METHODS.items()}
            if n == JUDGED_AT:
                rows += [verdict(sensor, maps, shown, electrons) for shown in QUANTITIES]
                continue
            for name, found in maps.items():
                for shown in QUANTITIES:
                    error = logarithmic(sensor, found, shown.map_name)
                    point = (n, float(error.mean()), float(error.std()))
                    errors.setdefault((name, shown.map_name), []).append(point)
        swept[electrons] = errors
    with style.house_style():
        for shown in QUANTITIES:
            drawn(shown, swept).savefig(folder / f"{shown.file}.png")
    print_table(rows)


def recorded(
    sensor: Sensor, electrons: float, rng: np.random.Generator
) -> Iterator[tuple[int, ExposurePair]]:
    """Yield the moments of the first 11, 21, … frames, and of the first 100."""
    taps = np.zeros(PIXELS, np.uint8)
    both = [PixelAccumulator(taps, FULL_SCALE_DN) for _ in range(2)]
    n = 0
    for until in sorted({*range(1, LAST + 1, STEP), JUDGED_AT}):
        for accumulator, factor in zip(both, (1, 2), strict=True):
            accumulator.add(sensor.frames(factor * electrons, until - n, rng))
        n = until
        if n > 2:
            first, second = (ExposureMoments.of(each.sums) for each in both)
            yield n, ExposurePair(first, second)


def logarithmic(sensor: Sensor, maps: PixelMaps, name: str) -> NDArray[np.float64]:
    """Return |log10 |x/true|| of every pixel that is told; the paper does not say its base."""
    ratio = np.abs(getattr(maps, name) / sensor.truth[name])
    known = np.isfinite(ratio) & (ratio > 0)
    return np.asarray(np.abs(np.log10(ratio[known])))


def verdict(sensor: Sensor, maps: dict[str, PixelMaps], shown: Shown, electrons: float) -> str:
    """Return how much nearer to the truth SANUC is, as a row of the table."""
    true = sensor.truth[shown.map_name]
    off = {name: np.abs(getattr(found, shown.map_name) - true) for name, found in maps.items()}
    both = np.isfinite(off["S3NUC"]) & np.isfinite(off["SANUC"])
    ratio = float(np.median(off["S3NUC"][both]) / np.median(off["SANUC"][both]))
    wins = 100.0 * float(np.mean(off["SANUC"][both] < off["S3NUC"][both]))
    told = 100.0 * float(np.mean(np.isfinite(off["S3NUC"])))
    wins_cell = "alike" if shown is QUANTITIES[0] else f"{wins:.1f} %"
    return f"| {electrons:,} | {shown.title} | {ratio:.3g} | {wins_cell} | {told:.1f} % |"


def print_table(rows: list[str]) -> None:
    """Print it in Markdown."""
    print(f"at {JUDGED_AT} frames\n")
    print("| K̄ (e⁻) | quantity | error of S3NUC / of SANUC | SANUC nearer on | told by S3NUC |")
    print("|---|---|---|---|---|")
    print("\n".join(rows))


def drawn(shown: Shown, swept: dict[float, Errors]) -> Figure:
    """Return one figure: a panel for each number of photo-electrons."""
    figure = style.new_figure(9.6, 3.0)
    panels = figure.subplots(1, len(swept), sharey=True)
    points = [p for errors in swept.values() for m in METHODS for p in errors[m, shown.map_name]]
    bottom, top = min(p[1] for p in points) / 5.0, 1.5 * max(p[1] + p[2] for p in points)
    for axes, (electrons, errors) in zip(panels, swept.items(), strict=True):
        for method, (_, colour) in METHODS.items():
            n, mean, std = np.array(errors[method, shown.map_name]).T
            low = np.minimum(std, mean - bottom / 10.0)  # a bar that reaches 0 leaves the panel
            size, shift = (4.5, 0.0) if method == "S3NUC" else (2.6, 4.0)
            axes.errorbar(
                n + shift, mean, (low, std), fmt="o", ms=size, mew=0.8, mfc=OPEN[method],
                color=colour, elinewidth=0.6, label=method,
            )  # fmt: skip
        axes.set_title(f"K̄ = {electrons:,} e⁻")
        axes.set_yscale("log")
        axes.set_ylim(bottom, top)
        axes.set_xticks([0, 250, 500])
        axes.set_xlabel("frames")
    panels[0].set_ylabel(f"{shown.title.lower()}:\n|log₁₀ |estimate / truth||")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside right upper")
    return figure


if __name__ == "__main__":
    main()
