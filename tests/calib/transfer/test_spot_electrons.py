"""A spot's photo-electrons from two exposures: exact sums, honest uncertainties, clear refusals."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from numpy.random import Generator

from calib.errors import DarkflatError
from calib.kernels.noise import draw_codes
from calib.transfer.source_radiometry.region_sums import Mask
from calib.transfer.source_radiometry.spot_electrons import SpotElectrons, spot_photoelectrons
from calib.transfer.two_exposures.exposure_pair import ExposureMoments, ExposurePair

N_SPOT, N_GROUND = 600, 400
SPOT = np.arange(N_SPOT + N_GROUND) < N_SPOT


@dataclass(frozen=True)
class Scene:
    """What a spot is like: `ratio` is the longer exposure over the shorter one."""

    mean_e: float = 40.0
    dark_e: float = 0.5
    read_std_e: float = 3.0
    gain: float = 20.9
    ratio: float = 2.0
    n_frames: int = 50

    def light_e(self) -> np.ndarray:
        """Expected photo-electrons of each pixel: brighter and dimmer ones, none on the ground."""
        profile = 0.5 + np.arange(N_SPOT) / N_SPOT
        return self.mean_e * np.concatenate([profile, np.zeros(N_GROUND)])

    def drawn(self, rng: Generator) -> ExposurePair:
        """Return both exposures' moments; offsets differ from pixel to pixel."""
        offset = 900.0 + rng.normal(0.0, 20.0, SPOT.size)
        first, second = (
            moments(
                draw_codes(
                    times * self.light_e()[np.newaxis], np.ones(self.n_frames),
                    np.full(SPOT.size, times * self.dark_e),
                    read_std_e=self.read_std_e, gain_dn_per_e=np.full(SPOT.size, self.gain),
                    offset_dn=offset, full_scale_dn=65535, full_well_e=np.inf,
                    key=int(rng.integers(1 << 63)),
                )
            )
            for times in (1.0, self.ratio)
        )  # fmt: skip
        return ExposurePair(first, second, self.ratio)


def moments(dn: np.ndarray) -> ExposureMoments:
    n, nobody = len(dn), np.zeros(dn.shape[1], np.uint32)
    mean, variance = dn.mean(0, dtype=np.float64), dn.var(0, ddof=1, dtype=np.float64)
    return ExposureMoments(n, n - 1, mean, variance, 0 * mean, nobody, nobody)


def found(scene: Scene, rng: Generator) -> SpotElectrons:
    return spot_photoelectrons(scene.drawn(rng), spot=SPOT, ground=~SPOT)


SCENES = {
    "as in the paper": Scene(),
    "shot noise alone, few electrons": Scene(mean_e=1.2, dark_e=0.0, read_std_e=0.2, n_frames=30),
    "dark current": Scene(dark_e=30.0),
    "noisy": Scene(read_std_e=9.0),
    "tripled exposure": Scene(ratio=3.0, n_frames=30),
}
N_RUNS = 400


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_z_scores_have_mean_0_and_standard_deviation_1(scene: Scene) -> None:
    children = np.random.default_rng(7).spawn(N_RUNS)
    every = [found(scene, rng) for rng in children]
    truths = {
        "system_gain": scene.gain,
        "photoelectrons": scene.light_e().sum(),
        "ground": scene.dark_e,
    }
    for name, truth in truths.items():
        estimates = [getattr(each, name) for each in every]
        z = np.array([(e.value - truth) / e.std for e in estimates])
        # What is left of a ratio's bias: the square of its relative error, in units of that error.
        bias = estimates[0].std / abs(truth) if name != "ground" else 0.0
        assert abs(z.mean()) < 4 / np.sqrt(N_RUNS) + bias, name
        assert abs(z.std() - 1) < 4 / np.sqrt(2 * N_RUNS), name


def test_offsets_and_the_order_of_pixels_do_not_matter() -> None:
    pair = Scene().drawn(np.random.default_rng(1))
    order = np.random.default_rng(2).permutation(SPOT.size)
    shift = np.random.default_rng(3).normal(0.0, 1e3, SPOT.size)
    first, second = (
        replace(e, mean_dn=(e.mean_dn + shift)[order], variance_dn2=e.variance_dn2[order])
        for e in (pair.first, pair.second)
    )
    plain = spot_photoelectrons(pair, spot=SPOT, ground=~SPOT)
    again = spot_photoelectrons(ExposurePair(first, second), spot=SPOT[order], ground=~SPOT[order])
    assert again.photoelectrons.value == pytest.approx(plain.photoelectrons.value, rel=1e-9)
    assert again.photoelectrons.std == pytest.approx(plain.photoelectrons.std, rel=1e-9)


def test_without_noise_the_charge_is_exact() -> None:
    """D = G k + B and V = G^2 k + noise, put in by hand: 2 DN/e-, 10 and 20 e- in each pixel."""
    offset = np.linspace(0.0, 50.0, SPOT.size)
    plain = moments(np.zeros((1000, SPOT.size)))
    k = np.where(SPOT, 10.0, 0.0)
    first, second = (
        replace(plain, mean_dn=2 * times * k + offset, variance_dn2=4 * times * k + 9.0)
        for times in (1.0, 2.0)
    )
    result = spot_photoelectrons(ExposurePair(first, second), spot=SPOT, ground=~SPOT)
    assert result.system_gain.value == pytest.approx(2.0, rel=1e-12)
    assert result.photoelectrons.value == pytest.approx(10.0 * N_SPOT, rel=1e-12)
    assert result.ground.value == pytest.approx(0.0, abs=1e-12)
    assert result.answer()["pixels"] == N_SPOT


def test_pixels_with_charge_and_no_light_are_taken_off() -> None:
    """A third of the region is ground: dark electrons double with the exposure, too."""
    scene = Scene(dark_e=20.0, n_frames=400)
    wide: Mask = np.arange(SPOT.size) < N_SPOT + 200
    result = spot_photoelectrons(scene.drawn(np.random.default_rng(5)), spot=wide, ground=~wide)
    truth = scene.light_e().sum()
    assert abs(result.photoelectrons.value - truth) < 4 * result.photoelectrons.std
    assert result.photoelectrons.std < 0.02 * truth


def test_an_unsure_ratio_of_the_exposures_enters_the_charge_and_not_the_gain() -> None:
    pair = Scene().drawn(np.random.default_rng(1))
    sure = spot_photoelectrons(pair, spot=SPOT, ground=~SPOT)
    unsure = spot_photoelectrons(replace(pair, ratio_std=0.03), spot=SPOT, ground=~SPOT)
    added = 0.03 * sure.photoelectrons.value
    wanted = np.hypot(sure.photoelectrons.std, added)
    assert unsure.photoelectrons.std == pytest.approx(wanted, rel=1e-9)
    assert unsure.system_gain == sure.system_gain


def refusing(change: str) -> dict[str, Any]:
    pair = Scene().drawn(np.random.default_rng(1))
    clipped = np.where(np.arange(SPOT.size) == 3, 1, 0).astype(np.uint32)
    cases: dict[str, dict[str, Any]] = {
        "mask of another size": {"spot": SPOT[:-1]},
        "numbers as a mask": {"spot": SPOT.astype(np.float64)},
        "empty ground": {"ground": np.zeros_like(SPOT)},
        "shared pixels": {"ground": np.ones_like(SPOT)},
        "longer one first": {"pair": ExposurePair(pair.second, pair.first, 0.5)},
        "clipped pixels": {
            "pair": replace(pair, second=replace(pair.second, at_full_scale=clipped))
        },
        "pixels at code 0": {"pair": replace(pair, first=replace(pair.first, at_zero=clipped))},
        "no light": {"pair": Scene(mean_e=0.0, dark_e=0.0).drawn(np.random.default_rng(1))},
        "nothing at all": {"pair": replace(pair, second=pair.first)},
    }
    return {"pair": pair, "spot": SPOT, "ground": ~SPOT, **cases[change]}


REFUSALS = {
    "mask of another size": "bad-region",
    "numbers as a mask": "bad-region",
    "empty ground": "bad-region",
    "shared pixels": "bad-region",
    "longer one first": "bad-exposures",
    "clipped pixels": "clipped",
    "pixels at code 0": "clipped",
    "no light": "no-light",
    "nothing at all": "no-light",
}


@pytest.mark.parametrize(("change", "code"), REFUSALS.items(), ids=REFUSALS)
def test_what_cannot_be_evaluated_is_refused_in_one_sentence(change: str, code: str) -> None:
    given = refusing(change)
    with pytest.raises(DarkflatError, match=r"^[^\n]+: [^\n]+$") as caught:
        spot_photoelectrons(**given)
    assert caught.value.code == code
