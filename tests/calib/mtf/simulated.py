"""Simulated benches of different sizes, and what a perfect fit of them would say."""

from dataclasses import dataclass, field

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.stats import chi2, norm

from calib.mtf.estimation.compact_psf import Harmonic
from calib.mtf.estimation.harmonic_fit import HarmonicFit
from calib.mtf.estimation.sandwich import Sandwich
from calib.mtf.estimation.state import State
from calib.mtf.geometry import Alignment, Sampling, Scan
from calib.mtf.grating.grating import Grating
from calib.mtf.scan_images import ScanImages
from calib.mtf.simulation.bench import Bench
from calib.mtf.simulation.detector import DetectorNoise
from calib.mtf.simulation.response import PixelResponse, centred
from calib.mtf.simulation.shapes import truncated_corner

PITCH_UM = 25.0
PAPER = Scan(PITCH_UM, 1, 6)
ORDERS_24 = Grating(650, 500.0)
ORDERS_48 = Grating(5525, 2 * 5525**0.5 / 0.120)
SMALL = Scan(PITCH_UM, 1, 3)
ORDERS_12 = Grating(50, 340.0)
CORNER = truncated_corner(25.0, 10.0, 0.2, 2.5)
"""Section 4's pixel."""
QUIET = DetectorNoise(shot_noise=True, averaged=100)


@dataclass(frozen=True, eq=False)
class Case:
    """A bench and a recording of it."""

    bench: Bench
    scan: ScanImages

    def stage_um(self, fit: HarmonicFit) -> NDArray[np.floating]:
        """The true stage errors of a fit's frames, counted as the fit counts them."""
        stage = self.bench.alignment.stage_um
        every = np.zeros((self.bench.scan.positions, 2)) if stage is None else stage
        of_frames = every[list(fit.state.sampling.frames)]
        return of_frames - of_frames[fit.state.steady].mean(axis=0)

    def shift_um(self, fit: HarmonicFit) -> NDArray[np.floating]:
        """Where the pattern lies with the PSF's centroid at 0, for stage errors counted so."""
        stage = self.bench.alignment.stage_um
        every = np.zeros((self.bench.scan.positions, 2)) if stage is None else stage
        middle = every[list(fit.state.sampling.frames)][fit.state.steady].mean(axis=0)
        tilt = self.bench.scan.tilt_rad + self.bench.alignment.tilt_rad
        turn = np.array([[np.cos(tilt), -np.sin(tilt)], [np.sin(tilt), np.cos(tilt)]])
        centroid = turn @ np.array(self.bench.response.centroid_um)
        size = 1 + self.bench.alignment.scale  # the pattern's lengths are that much shorter there
        return self.bench.alignment.shift_um - middle + size * centroid

    def transfer(self, fit: HarmonicFit) -> NDArray[np.complexfloating]:
        """Return the true transfers at a fit's harmonics, phases about the fit's shift."""
        fx, fy = fit.detector_per_um.T
        away = self.shift_um(fit) - fit.state.sampling.alignment.shift_um
        turn = np.exp(-2j * np.pi * (fit.state.harmonics.frequency_per_um @ away))
        return centred(self.bench.response, fx, fy) * turn


def record(
    rng: Generator,
    shape: tuple[int, int] = (48, 48),
    *,
    scan: Scan = PAPER,
    grating: Grating = ORDERS_24,
    response: PixelResponse = CORNER,
    alignment: Alignment | None = None,
    detector: DetectorNoise = QUIET,
    missing: tuple[int, ...] = (),
) -> Case:
    """Simulate a recording."""
    bench = Bench(scan, grating, response, shape, alignment or Alignment(), detector)
    images = bench.record(rng)
    kept = tuple(k for k in range(scan.positions) if k not in missing)
    return Case(bench, ScanImages(scan, grating, images[list(kept)], kept))


def misaligned(rng: Generator, scan: Scan = PAPER) -> Alignment:
    """Draw a bench as people leave it: any shift, 0.1° of tilt, 0.1 µm of stage error."""
    stage = rng.normal(scale=0.1, size=(scan.positions, 2))
    return Alignment(
        rng.uniform(-80, 80, 2), rng.normal(scale=5e-4), rng.normal(scale=np.radians(0.1)), stage
    )


def exact_fit(
    response: PixelResponse,
    grating: Grating,
    shape: tuple[int, int] = (64, 64),
    std: float = 1e-7,
) -> HarmonicFit:
    """Return what a fit of noise-free images would find, with a given std of each transfer."""
    harmonics = grating.harmonics
    sampling = Sampling.whole(PAPER, shape, Alignment(stage_um=np.zeros((PAPER.positions, 2))))
    transfer = centred(response, *sampling.to_detector(harmonics.frequency_per_um).T)
    amplitude = np.concatenate([[0.5 + 0j], harmonics.amplitude * transfer])
    state = State(
        harmonics, sampling, amplitude, np.ones(PAPER.positions), np.ones(PAPER.positions, bool)
    )
    variance = np.zeros(state.layout.size)
    variance[1 : len(harmonics) + 1] = np.abs(std * harmonics.amplitude) ** 2
    variance[state.layout.imaginary] = variance[1 : len(harmonics) + 1]
    nothing = np.zeros(shape)
    covariance = Sandwich(np.diag(variance), np.eye(len(variance)), np.inf)
    return HarmonicFit(
        state, covariance, np.zeros((PAPER.positions, *shape)), 0.0, nothing, nothing, 0.0,
        np.ones(shape, bool),
    )  # fmt: skip


def harmonics_of(fit: HarmonicFit) -> Harmonic:
    """Return a fit's transfers as the regularised estimate takes them."""
    return Harmonic(fit.detector_per_um, fit.transfer, fit.transfer_covariance)


@dataclass
class Scores:
    """Mean and mean square of z by recording: what is within a recording may be correlated."""

    means: list[float] = field(default_factory=list)
    squares: list[float] = field(default_factory=list)
    numbers: int = 0

    def add(self, z: NDArray[np.floating]) -> None:
        """Add the z-scores of one recording."""
        self.means.append(float(z.mean()))
        self.squares.append(float((z**2).mean()))
        self.numbers += z.size

    def check(self, name: str, *, standard_errors: float = 4.5) -> None:
        """Assert mean 0 and mean square 1 within so many of their standard errors."""
        root = np.sqrt(len(self.means))
        mean, square = np.array(self.means), np.array(self.squares)
        assert abs(mean.mean()) < standard_errors * mean.std(ddof=1) / root, (
            f"{name}: {mean.mean()}"
        )
        away = abs(square.mean() - 1)
        # Few squares that happen to be small scatter little, too: of independent numbers
        # chi-squared is as unlikely to be below this.
        least = chi2.ppf(norm.sf(standard_errors), self.numbers) / self.numbers
        near = away < standard_errors * square.std(ddof=1) / root
        assert near or least < square.mean() < 1, f"{name}: {square.mean()}"
