"""The experiment of Yielding, Cain and Seal (2018), section 4, on a simulated bench.

    python examples/led_pinhole.py [--out docs/gallery] [--runs 6] [--read-noise 3]

An LED lights a pinhole of 200 um at 4.33 m, whose image fills 200 pixels of a 14-bit area camera;
100 frames of 100 ms and of 200 ms go through the sequencer into a recording. Each run has a source
drawn from between the bounds of the paper's Table 3, a sensor of its own, and a data sheet whose
quantum efficiency is off by its uncertainty. What the camera counts is compared with the photons
that the source sent. It prints what docs/photon-transfer/source-radiometry.md quotes.
"""

import argparse
import os
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from numpy.random import Generator
from numpy.typing import NDArray

from calib.forward.effects.illumination import Illumination
from calib.forward.model import Model
from calib.kernels.noise import draw_codes
from calib.recording.file_recording import FileRecording
from calib.report import style
from calib.transfer.estimate import Estimate
from calib.transfer.source_radiometry.diverging_source import photons_through_aperture
from calib.transfer.source_radiometry.photons_from_electrons import photons_from_electrons
from calib.transfer.source_radiometry.spot_electrons import SpotElectrons, spot_photoelectrons
from calib.transfer.source_radiometry.yielding_2018 import LED555L
from calib.transfer.two_exposures.exposure_pair import ExposurePair
from calib.transfer.two_exposures.two_exposures import two_exposure_moments
from service.bench import BenchSettings, open_bench
from service.plan.model import Plan
from service.sequencer.run import run_plan

SIDE = 256  # rows and columns around the spot: a part of the sensor is enough, and quick
FRAMES = 100
EXPOSURES_US = (100_000.0, 200_000.0)
LIT_RADIUS = 95.0  # within it every pixel has all of its light
SPOT_RADIUS, GROUND_RADIUS = 108.0, 116.0  # within the first all light falls, beyond the other none
MEAN_E = 39.0  # of a pixel of the spot in the shorter exposure
EFFICIENCY = 0.55
EFFICIENCY_STD = 0.0055  # of the data sheet's figure, 1 %


def main() -> None:
    """Run the experiment some times, draw a figure, print what it gave."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("docs/gallery"))
    parser.add_argument("--runs", type=int, default=6)
    parser.add_argument("--read-noise", type=float, default=3.0, help="of the camera, e-")
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    every = list(runs(asked.runs, seed=2018, read_noise_e=asked.read_noise))
    print_table(every)
    with style.house_style():
        figure(every, asked.read_noise).savefig(asked.out / "led-pinhole.png")


@dataclass(frozen=True)
class Run:
    """One experiment.

    Attributes:
        frame: Mean code of the shorter exposure, (SIDE, SIDE).
        true_photons, true_electrons: What the source sent, and what the sensor made of it on
            average, in the shorter exposure.
        found: By pooling over the spot.
        photons: From `found` and the data sheet's quantum efficiency.
        by_pixel: SANUC's K of each lit pixel, e-; NaN where the variance does not change.
        decided: Lit pixels whose variance rises by its own standard error or more.
        expected_by_pixel: What it should be, e-.
    """

    frame: NDArray[np.float64]
    true_photons: float
    true_electrons: float
    found: SpotElectrons
    photons: Estimate
    by_pixel: NDArray[np.float64]
    decided: NDArray[np.bool_]
    expected_by_pixel: NDArray[np.float64]

    @property
    def error(self) -> float:
        """Relative error of the pooled photo-electrons."""
        return self.found.photoelectrons.value / self.true_electrons - 1

    @property
    def z(self) -> float:
        """Error of the photons in units of their stated standard uncertainty."""
        return (self.photons.value - self.true_photons) / self.photons.std

    @property
    def error_of_sum(self) -> float:
        """Relative error of the sum of all lit pixels' own estimates."""
        return float(np.nansum(self.by_pixel) / self.expected_by_pixel.sum()) - 1

    @property
    def error_of_decided(self) -> float:
        """Likewise, of the pixels that are decided."""
        kept, wanted = self.by_pixel[self.decided], self.expected_by_pixel[self.decided]
        return float(kept.sum() / wanted.sum()) - 1


def one_run(rng: Generator, *, read_noise_e: float = 3.0) -> Run:
    """Draw a source and a sensor, measure them on the bench, and evaluate."""
    drawn = {name: given.drawn(1, rng) for name, given in LED555L.inputs().items()}
    drawn["exposure_s"] = np.array([EXPOSURES_US[0] * 1e-6])
    true_photons = float(photons_through_aperture(**drawn)[0])
    model = pinhole_model(true_photons, rng, read_noise_e=read_noise_e)
    with TemporaryDirectory() as folder:
        pair = measured(model, Path(folder), seed=int(rng.integers(1 << 31)))
    lit, spot, ground = regions()
    found = spot_photoelectrons(pair, spot=spot, ground=ground)
    data_sheet = Estimate(rng.normal(EFFICIENCY, EFFICIENCY_STD), EFFICIENCY_STD, "e-/photon")
    light, dark = expected_electrons(model)
    by_pixel, decided = pixel_electrons(pair)
    return Run(
        frame=pair.first.mean_dn.reshape(SIDE, SIDE),
        true_photons=true_photons,
        true_electrons=float(light.sum()),
        found=found,
        photons=photons_from_electrons(found.photoelectrons, data_sheet),
        by_pixel=by_pixel[lit],
        decided=decided[lit],
        expected_by_pixel=(light + dark)[lit],
    )


def pixel_electrons(pair: ExposurePair) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return SANUC's Equation 18 with 17 put in, (D2 - D1)^2 / (V2 - V1), and where it is decided.

    That is where V2 - V1 is at least its own standard error, of Gaussian noise.
    """
    rise_dn2 = pair.variance_difference_dn2
    unknown = np.full_like(rise_dn2, np.nan)
    electrons = np.divide(pair.difference_dn**2, rise_dn2, out=unknown, where=rise_dn2 != 0)
    both_dn2 = np.hypot(pair.first.variance_dn2, pair.second.variance_dn2)
    return electrons, rise_dn2 >= both_dn2 * np.sqrt(2 / (FRAMES - 1))


def pinhole_model(photons: float, rng: Generator, *, read_noise_e: float) -> Model:
    """Return a sensor of the preset's make that sees `photons` in the shorter exposure."""
    preset = Model.preset("stingray-f504b")
    camera = preset.camera.model_copy(update={"rows": SIDE, "columns": SIDE})
    seeds = {"responsivity": "prnu_seed", "offset": "pattern_seed", "dark_current": "dsnu_seed"}
    changed = {name: {seed: int(rng.integers(1 << 31))} for name, seed in seeds.items()}
    changed["read_noise"] = {"std_e": read_noise_e}
    effects = tuple(
        replace(e, **changed[e.name]) if e.name in changed else e  # type: ignore[type-var]
        for e in preset.effects
    )
    share = preset.effect("spot").profile((SIDE, SIDE)).sum()  # type: ignore[union-attr]
    lamp = Illumination(radiance=(photons / (EXPOSURES_US[0] * float(share)),))
    return replace(preset, camera=camera, effects=effects).with_effect(lamp)


def measured(model: Model, folder: Path, *, seed: int) -> ExposurePair:
    """Take both exposures on an in-process bench; return their pixels' moments."""
    model.save(folder / "camera.toml")
    bench = {
        "id": f"led-pinhole-{os.getpid()}",
        "camera": {"driver": "mock", "paced": False},
        "light": {"driver": "mock", "tau_s": 0.0, "ramp_s": 0.0},
        "shutter": {"driver": "mock"},
        "simulation": {"model": str(folder / "camera.toml"), "lamps": 1, "seed": seed},
    }
    plan = {
        "name": "LED behind a pinhole",
        "sweep": {
            "type": "listed",
            "blocks": [{"exposure_us": each, "level": 1} for each in EXPOSURES_US],
        },
        "camera": {
            "line_period_us": 250_000.0,
            "pixel_format": "Mono14",
            "gain_db": 20.0,
            "black_level_dn": 600.0,  # on top of the offset, so that a noisier sensor clips nothing
        },
        "source": {"kind": "led", "lamps": 1, "wavelength_nm": 555.0},
        "settle": {"stable_for_s": 0.0, "without_monitor_s": 0.0},
        "lines": FRAMES,
    }
    with open_bench(BenchSettings.parse(bench)) as opened:
        run_plan(opened, Plan.parse(plan), folder / "led.h5")
    return two_exposure_moments(FileRecording(folder / "led.h5")).pair


def regions() -> tuple[NDArray[np.bool_], ...]:
    """Return the lit pixels, spot and ground, flat, (SIDE * SIDE,)."""
    along = np.arange(SIDE) - (SIDE - 1) / 2
    radius = np.hypot(along[:, np.newaxis], along).ravel()
    return radius <= LIT_RADIUS, radius <= SPOT_RADIUS, radius >= GROUND_RADIUS


def expected_electrons(model: Model) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the electrons of light and of the dark of each pixel in the shorter exposure, flat."""
    truth, exposure_us = model.truth(), EXPOSURES_US[0]
    (radiance,) = model.effect("illumination").radiance  # type: ignore[union-attr]
    spot = model.effect("spot").profile((SIDE, SIDE))  # type: ignore[union-attr]
    gain = truth.system_gain_dn_per_e
    light = radiance * exposure_us * spot * truth.responsivity / gain
    return light.ravel(), (truth.dark_signal_dn_per_us * exposure_us / gain).ravel()


def runs(n: int, *, seed: int, read_noise_e: float = 3.0) -> Iterator[Run]:
    """Yield `n` experiments, each with a generator of its own."""
    for child in np.random.default_rng(seed).spawn(n):
        yield one_run(child, read_noise_e=read_noise_e)


def print_table(every: list[Run]) -> None:
    """Print, as a Markdown table, how the runs came out."""
    errors, z = np.array([run.error for run in every]), np.array([run.z for run in every])
    own = np.array([run.found.photoelectrons.std / run.true_electrons for run in every])
    sums = 100 * np.array([run.error_of_sum for run in every])
    decided = 100 * np.array([run.error_of_decided for run in every])
    rows = (
        ("runs", f"{len(every)}"),
        ("photons within k = 2", f"{np.sum(np.abs(z) <= 2)}"),
        ("z of the photons, mean and standard deviation", f"{z.mean():+.2f}, {z.std(ddof=1):.2f}"),
        ("pooled photo-electrons, mean error", f"{100 * errors.mean():+.3f} %"),
        ("their scatter", f"{100 * errors.std(ddof=1):.3f} %"),
        ("their stated standard uncertainty", f"{100 * own.mean():.3f} %"),
        ("z of the photo-electrons, standard deviation", f"{(errors / own).std(ddof=1):.2f}"),
        ("within 0.5 % of the truth", f"{np.sum(np.abs(errors) <= 0.005)}"),
        ("sum of the lit pixels' own estimates, median error", f"{np.median(sums):+.1f} %"),
        ("from the lowest to the highest", f"{sums.min():+.0f} … {sums.max():+.0f} %"),
        ("of the decided among them, mean error", f"{decided.mean():+.1f} %"),
        ("from the lowest to the highest", f"{decided.min():+.1f} … {decided.max():+.1f} %"),
        ("share that is decided", f"{100 * np.mean([run.decided.mean() for run in every]):.1f} %"),
    )  # fmt: skip
    for name, value in rows:
        print(f"| {name} | {value} |")


def figure(every: list[Run], read_noise_e: float) -> Figure:
    """Draw the spot, its pixels' own estimates, both sums of all runs, and why they differ."""
    drawn = style.new_figure(8.4, 6.8)
    axes = drawn.subplots(2, 2)
    draw_frame(axes[0, 0], every[0])
    draw_pixels(axes[0, 1], every[0])
    draw_runs(axes[1, 0], every)
    draw_frame_counts(axes[1, 1], read_noise_e)
    return drawn


def draw_frame(axes: Axes, run: Run) -> None:
    """Draw the mean frame, and where spot and ground end."""
    image = axes.imshow(run.frame, cmap="gray")
    axes.figure.colorbar(image, ax=axes, label="DN")
    middle = (SIDE - 1) / 2
    for radius, colour in ((SPOT_RADIUS, style.BLUE), (GROUND_RADIUS, style.ORANGE)):
        axes.add_patch(Circle((middle, middle), radius, fill=False, color=colour))
    axes.set(title="Spot (blue), ground (beyond orange)", xlabel="column", ylabel="row")
    axes.grid(visible=False)


def draw_pixels(axes: Axes, run: Run) -> None:
    """Draw how each pixel's own estimate is distributed about the truth."""
    ratio = run.by_pixel / run.expected_by_pixel
    axes.hist(ratio, bins=np.linspace(0, 5, 101), color=style.GREY)
    axes.axvline(1.0, color=style.INK, label="truth")
    axes.axvline(float(np.nanmean(ratio)), color=style.ORANGE, label="mean of the pixels")
    axes.set_yscale("log")
    axes.legend()
    axes.set(
        title="Each pixel's own estimate",
        xlabel="(D2 − D1)² / (V2 − V1) over true electrons",
        ylabel="pixels",
    )


def draw_runs(axes: Axes, every: list[Run]) -> None:
    """Draw the error of both sums, run by run."""
    number = np.arange(1, len(every) + 1)
    pooled = 100 * np.array([run.error for run in every])
    own = 100 * np.array([run.found.photoelectrons.std / run.true_electrons for run in every])
    sums = 100 * np.array([run.error_of_sum for run in every])
    decided = 100 * np.array([run.error_of_decided for run in every])
    low, high = -10.0, 40.0
    for beyond, marker in ((sums > high, "^"), (sums < low, "v"), (abs(sums - 15) <= 25, "x")):
        axes.plot(number[beyond], sums[beyond].clip(low, high), marker, color=style.GREY)
    axes.plot([], [], "x", color=style.GREY, label="sum over pixels; triangles: beyond")
    axes.plot(number, decided, "s", color=style.ORANGE, label="of those that are decided")
    axes.errorbar(
        number, pooled, 2 * own, fmt=".", capsize=3, color=style.BLUE, label="pooled, k = 2"
    )
    axes.set(ylim=(low - 2, high + 22), xlabel="run", ylabel="error of the photo-electrons, %")
    axes.set_title("The whole spot, run by run")
    axes.set_xticks(number[:: max(1, len(every) // 8)])
    axes.legend(loc="upper left")


def draw_frame_counts(axes: Axes, read_noise_e: float) -> None:
    """Draw how the sum over pixels nears the truth as frames are added, and its first order."""
    counts = np.array([30, 50, 100, 200, 500])
    for read_std_e, colour in ((0.8, style.GREEN), (read_noise_e, style.ORANGE)):
        errors = [100 * ratio_bias(int(n), read_std_e) for n in counts]
        variances = np.array([1.0, 2.0]) * MEAN_E + read_std_e**2
        first_order = 200 * np.sum(variances**2) / MEAN_E**2 / (counts - 1)
        axes.loglog(counts, errors, "o", color=colour, label=f"{read_std_e:g} e- of read noise")
        axes.loglog(counts, first_order, color=colour, label="its first order")
    axes.set_xticks(counts, labels=[str(n) for n in counts])
    ticks = (2, 5, 10, 20, 50)
    axes.set_yticks(ticks, labels=[str(tick) for tick in ticks])
    axes.minorticks_off()
    axes.legend(loc="upper right")
    axes.set(
        title="Why: a ratio's bias", xlabel="frames of each exposure", ylabel="median error, %"
    )


def ratio_bias(n_frames: int, read_std_e: float, repeats: int = 5) -> float:
    """Return the median relative error of the sum over 30,000 pixels of `MEAN_E` electrons."""
    ones, errors = np.ones(30_000), []
    for repeat in range(repeats):
        mean, variance = [], []
        for times in (1, 2):
            dn = draw_codes(
                times * MEAN_E * ones[np.newaxis], np.ones(n_frames), 0 * ones,
                read_std_e=read_std_e, gain_dn_per_e=20.9 * ones, offset_dn=1000 * ones,
                full_scale_dn=65535, full_well_e=np.inf, key=100 * n_frames + 2 * repeat + times,
            )  # fmt: skip
            mean.append(dn.mean(0))
            variance.append(dn.var(0, ddof=1))
        ratio = (mean[1] - mean[0]) ** 2 / (variance[1] - variance[0])
        errors.append(ratio.sum() / (MEAN_E * ones.size) - 1)
    return float(np.median(errors))


if __name__ == "__main__":
    main()
