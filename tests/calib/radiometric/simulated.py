"""Small recordings of known truth, independent of the forward model."""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from calib.recording.block_statistics import BlockStatistics, RecordingStatistics
from calib.recording.header import Block, CameraHeader, RecordingHeader, SourceHeader


def smooth_profile(n: int, fall: float = 0.5, off_centre: float = 0.1) -> NDArray[np.float64]:
    """A vignette of degree 4 with its maximum a little off the centre."""
    x = np.linspace(-1.0, 1.0, n) - off_centre
    profile = 1.0 - fall * (0.7 * x**2 + 0.12 * x**4)
    return profile / profile.max()


@dataclass(frozen=True)
class Bench:
    """The truth, the plan and the errors that are drawn anew for each recording."""

    n: int = 256
    lines: int = 64
    bit_depth: int = 12
    gain: float = 0.15
    read_dn: float = 1.5
    offset_mean: float = 60.0
    offset_std: float = 4.0
    response: float = 1.6
    prnu: float = 0.015
    fall: float = 0.5
    exposures: tuple[float, ...] = (100.0, 200.0, 300.0, 400.0, 500.0)
    sweep_level: int = 3
    levels: tuple[int, ...] = (1, 2, 3, 4, 5)
    level_exposure: float = 200.0
    darks: int = 3
    unrest: float = 0.0
    line_noise_dn: float = 0.0
    certificate: float = 0.01
    level_error: float | None = 0.003
    dark_current: float = 0.0
    drift: float = 0.0
    monitor_noise: float | None = None

    def header(self) -> RecordingHeader:
        """The recording's header, stating the source's uncertainties."""
        stated = {"certificate_relative_std": self.certificate}
        if self.level_error is not None:
            stated["level_relative_std"] = self.level_error
        return RecordingHeader(
            camera=CameraHeader(columns=self.n, bit_depth=self.bit_depth),
            source=SourceHeader(kind="sphere", lamps=6, radiance_unit="W", **stated),
            blocks=tuple(self.conditions()),
        )

    def conditions(self) -> list[Block]:
        """Flats of the exposure sweep, of the level sweep, and darks."""
        flats = [(t, self.sweep_level) for t in self.exposures]
        flats += [(self.level_exposure, level) for level in self.levels]
        blocks = [
            Block(block=f"{k:03d}", kind="flat", exposure_us=t, level=g, radiance=float(g))
            for k, (t, g) in enumerate(flats)
        ]
        times = np.resize(self.exposures, self.darks)
        darks = [
            Block(block=f"d{k:02d}", kind="dark", exposure_us=float(t), level=0)
            for k, t in enumerate(times)
        ]
        return blocks + darks


@dataclass(frozen=True)
class Drawn:
    """One recording and the truth behind it."""

    statistics: RecordingStatistics
    offset: NDArray[np.float64]
    vignette: NDArray[np.float64]
    responsivity: NDArray[np.float64]
    noise_free: NDArray[np.float64]


def draw(bench: Bench, rng: Generator, *, pixels: bool = False, held_out: int = 0) -> Drawn:
    """Draw a recording; real rounded pixels, or the statistics that they would have.

    Without pixels the mean is normal and the variance is chi-squared, which holds where the noise
    is well above rounding (sigma over 0.6 DN) and no code is clipped.
    """
    vignette = smooth_profile(bench.n, bench.fall)
    responsivity = bench.response * (1.0 + bench.prnu * rng.standard_normal(bench.n))
    offset = bench.offset_mean + bench.offset_std * rng.standard_normal(bench.n)
    certificate = 1.0 + bench.certificate * rng.standard_normal()
    own = bench.level_error or 0.0
    level_factor = {g: 1.0 + own * rng.standard_normal() for g in range(20)}
    rows, held, truth = [], [], []
    n_flats = len(bench.exposures) + len(bench.levels)
    wander = np.append(1.0 + bench.drift * np.linspace(-0.5, 0.5, n_flats), np.ones(bench.darks))
    for condition, drifted in zip(bench.conditions(), wander, strict=True):
        light = condition.level * certificate * level_factor[int(condition.level)]
        light *= drifted * (1.0 + bench.unrest * rng.standard_normal())
        block = condition
        if bench.monitor_noise is not None and block.kind == "flat":
            reading = 1e-6 * light * (1.0 + bench.monitor_noise * rng.standard_normal())
            block = block.model_copy(update={"monitor": reading})
        signal = light * vignette * responsivity * block.exposure_us
        signal = signal + bench.dark_current * block.exposure_us
        truth.append(offset + signal)
        if pixels:
            every = held_out or bench.lines + 1
            dn = _pixels(bench, signal, offset, rng)
            out = np.arange(bench.lines) % every == every - 1
            rows.append(_measured(block, dn[~out], bench))
            held.append(_measured(block, dn[out], bench) if held_out else None)
        else:
            rows.append(_sufficient(block, bench, signal, offset, rng))
    left = tuple(h for h in held if h is not None)
    return Drawn(
        RecordingStatistics(tuple(rows), left), offset, vignette, responsivity, np.array(truth)
    )


def _pixels(
    bench: Bench, signal: NDArray[np.float64], offset: NDArray[np.float64], rng: Generator
) -> NDArray[np.float64]:
    shape = (bench.lines, bench.n)
    electrons = rng.poisson(signal / bench.gain, shape)
    volts = bench.gain * electrons + bench.read_dn * rng.standard_normal(shape) + offset
    volts += bench.line_noise_dn * rng.standard_normal((bench.lines, 1))
    return np.clip(np.rint(volts), 0, 2**bench.bit_depth - 1)


def _measured(block: Block, dn: NDArray[np.float64], bench: Bench) -> BlockStatistics:
    return BlockStatistics(
        block=block,
        n_lines=len(dn),
        mean_dn=dn.mean(axis=0),
        variance_dn2=dn.var(axis=0, ddof=1),
        n_at_zero=(dn == 0).sum(axis=0),
        n_at_full_scale=(dn == 2**bench.bit_depth - 1).sum(axis=0),
    )


def _sufficient(
    block: Block,
    bench: Bench,
    signal: NDArray[np.float64],
    offset: NDArray[np.float64],
    rng: Generator,
) -> BlockStatistics:
    own = bench.gain * signal + bench.read_dn**2 + 1.0 / 12.0
    total = own + bench.line_noise_dn**2
    shared = bench.line_noise_dn / np.sqrt(bench.lines) * rng.standard_normal()
    mean = offset + signal + np.sqrt(own / bench.lines) * rng.standard_normal(bench.n) + shared
    chi2 = rng.chisquare(bench.lines - 1, bench.n)
    none = np.zeros(bench.n, np.int64)
    return BlockStatistics(block, bench.lines, mean, total * chi2 / (bench.lines - 1), none, none)
