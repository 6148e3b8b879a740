"""A spot's photo-electrons from two exposures: exact sums, honest uncertainties, clear refusals."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.random import Generator

from calib.errors import DarkflatError
from calib.kernels.noise import draw_codes
from calib.recording.block_statistics import BlockStatistics
from calib.recording.header import Block
from calib.transfer.source_radiometry.region_sums import Mask
from calib.transfer.source_radiometry.spot_electrons import SpotElectrons, spot_photoelectrons

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

    def drawn(self, rng: Generator) -> tuple[BlockStatistics, BlockStatistics]:
        """Return both exposures' statistics; offsets differ from pixel to pixel."""
        offset = 900.0 + rng.normal(0.0, 20.0, SPOT.size)
        first, second = (
            statistics(
                draw_codes(
                    times * self.light_e()[np.newaxis], np.ones(self.n_frames),
                    np.full(SPOT.size, times * self.dark_e),
                    read_std_e=self.read_std_e, gain_dn_per_e=np.full(SPOT.size, self.gain),
                    offset_dn=offset, full_scale_dn=65535, full_well_e=np.inf,
                    key=int(rng.integers(1 << 63)),
                ),
                100.0 * times,
            )
            for times in (1.0, self.ratio)
        )  # fmt: skip
        return first, second


def statistics(dn: np.ndarray, exposure_us: float) -> BlockStatistics:
    n, nobody = len(dn), np.zeros(dn.shape[1], np.int64)
    block = Block(block="0", kind="flat", exposure_us=exposure_us, level=1)
    mean, variance = dn.mean(0, dtype=np.float64), dn.var(0, ddof=1, dtype=np.float64)
    return BlockStatistics(block, n, mean, variance, nobody, nobody)


def found(scene: Scene, rng: Generator) -> SpotElectrons:
    return spot_photoelectrons(*scene.drawn(rng), spot=SPOT, ground=~SPOT)


SCENES = {
    "as in the paper": Scene(),
    "shot noise alone, few electrons": Scene(mean_e=1.2, dark_e=0.0, read_std_e=0.2),
    "dark current": Scene(dark_e=30.0),
    "noisy": Scene(read_std_e=9.0),
    "tripled exposure": Scene(ratio=3.0, n_frames=30),
}
N_RUNS = 500


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
    first, second = Scene().drawn(np.random.default_rng(1))
    order = np.random.default_rng(2).permutation(SPOT.size)
    shift = np.random.default_rng(3).normal(0.0, 1e3, SPOT.size)
    moved = [
        replace(b, mean_dn=(b.mean_dn + shift)[order], variance_dn2=b.variance_dn2[order])
        for b in (first, second)
    ]
    plain = spot_photoelectrons(first, second, spot=SPOT, ground=~SPOT)
    again = spot_photoelectrons(*moved, spot=SPOT[order], ground=~SPOT[order])
    assert again.photoelectrons.value == pytest.approx(plain.photoelectrons.value, rel=1e-9)
    assert again.photoelectrons.std == pytest.approx(plain.photoelectrons.std, rel=1e-9)


def test_without_noise_the_charge_is_exact() -> None:
    """D = G k + B and V = G^2 k + noise, put in by hand: 2 DN/e-, 10 and 20 e- in each pixel."""
    offset = np.linspace(0.0, 50.0, SPOT.size)
    blocks = []
    for times in (1.0, 2.0):
        k = np.where(SPOT, 10.0 * times, 0.0)
        plain = statistics(np.zeros((1000, SPOT.size)), 100.0 * times)
        blocks.append(replace(plain, mean_dn=2 * k + offset, variance_dn2=4 * k + 9.0))
    result = spot_photoelectrons(*blocks, spot=SPOT, ground=~SPOT)
    assert result.system_gain.value == pytest.approx(2.0, rel=1e-12)
    assert result.photoelectrons.value == pytest.approx(10.0 * N_SPOT, rel=1e-12)
    assert result.ground.value == pytest.approx(0.0, abs=1e-12)
    assert result.answer()["pixels"] == N_SPOT


def test_pixels_with_charge_and_no_light_are_taken_off() -> None:
    """Half of the region is ground: dark electrons double with the exposure, too."""
    scene = Scene(dark_e=20.0, n_frames=400)
    wide: Mask = SPOT | (np.arange(SPOT.size) < N_SPOT + 200)
    result = spot_photoelectrons(*scene.drawn(np.random.default_rng(5)), spot=wide, ground=~wide)
    truth = scene.light_e().sum()
    assert abs(result.photoelectrons.value - truth) < 4 * result.photoelectrons.std
    assert result.photoelectrons.std < 0.02 * truth


def refusing(change: str) -> dict[str, object]:
    first, second = Scene().drawn(np.random.default_rng(1))
    dark = Scene(mean_e=0.0, dark_e=0.0).drawn(np.random.default_rng(1))
    clipped = np.where(np.arange(SPOT.size) == 3, 1, 0)
    cases: dict[str, dict[str, object]] = {
        "mask of another size": {"spot": SPOT[:-1]},
        "numbers as a mask": {"spot": SPOT.astype(np.float64)},
        "empty ground": {"ground": np.zeros_like(SPOT)},
        "shared pixels": {"ground": np.ones_like(SPOT)},
        "longer one first": {"first": second, "second": first},
        "two frames": {"first": replace(first, n_lines=2)},
        "clipped pixels": {"second": replace(second, n_at_full_scale=clipped)},
        "pixels at code 0": {"first": replace(first, n_at_zero=clipped)},
        "no light": {"first": dark[0], "second": dark[1]},
        "nothing at all": {"second": replace(first, block=second.block)},
    }
    return {"first": first, "second": second, "spot": SPOT, "ground": ~SPOT, **cases[change]}


REFUSALS = {
    "mask of another size": "bad-region",
    "numbers as a mask": "bad-region",
    "empty ground": "bad-region",
    "shared pixels": "bad-region",
    "longer one first": "bad-exposures",
    "two frames": "too-few-frames",
    "clipped pixels": "clipped",
    "pixels at code 0": "clipped",
    "no light": "no-light",
    "nothing at all": "no-light",
}


@pytest.mark.parametrize(("change", "code"), REFUSALS.items(), ids=REFUSALS)
def test_what_cannot_be_evaluated_is_refused_in_one_sentence(change: str, code: str) -> None:
    given = refusing(change)
    with pytest.raises(DarkflatError, match=r"^[^\n]+: [^\n]+$") as caught:
        spot_photoelectrons(**given)  # type: ignore[arg-type]
    assert caught.value.code == code
