"""System gain and read noise of a set: where they come from, and how sure they are."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from calib.radiometric.coefficients.provenance import Provenance
from calib.radiometric.estimation.choices import Choices
from calib.radiometric.estimation.from_statistics import Determined, determine
from calib.recording.block_statistics import RecordingStatistics
from tests.calib.radiometric.simulated import Bench, draw

TWELVE_BITS = Bench(n=256, lines=64)
EIGHT_BITS = Bench(
    n=256, lines=40, bit_depth=8, gain=0.004, read_dn=0.35, offset_mean=6.0, response=0.1,
    offset_std=1.0, darks=5,
)  # fmt: skip
LITTLE_NOISE = replace(EIGHT_BITS, read_dn=0.17)
BENCHES = {"12-bit": TWELVE_BITS, "8-bit": EIGHT_BITS, "8-bit-below-rounding": LITTLE_NOISE}


def determined(
    bench: Bench, rng: np.random.Generator, choices: Choices | None = None
) -> Determined:
    statistics = draw(bench, rng, pixels=True).statistics
    return determine(statistics, bench.header(), Provenance("0" * 64), choices)


def scores(bench: Bench, seeds: Iterable[int]) -> NDArray[np.float64]:
    """z of system gain and read noise, (n, 2)."""
    z = []
    for seed in seeds:
        c = determined(bench, np.random.default_rng([seed, bench.bit_depth])).coefficients
        assert c.provenance.parameters["system_gain_method"] == "photon transfer"
        gain = (c.system_gain_dn_per_e - bench.gain) / c.system_gain_dn_per_e_std
        read = (c.read_noise_e - bench.read_dn / bench.gain) / c.read_noise_e_std
        z.append((gain, read))
    return np.array(z)


def assert_covers(z: NDArray[np.float64], most_off: float) -> None:
    n = len(z)
    assert (np.abs(z.mean(axis=0)) < most_off + 4 / np.sqrt(n)).all()
    assert (np.abs(z.std(axis=0, ddof=1) - 1) < most_off + 4 / np.sqrt(2 * n)).all()


def test_gain_and_read_noise_are_as_sure_as_stated() -> None:
    assert_covers(np.concatenate([scores(b, range(5)) for b in BENCHES.values()]), 0.1)


@pytest.mark.soak
@pytest.mark.parametrize("bench", BENCHES.values(), ids=list(BENCHES))
def test_gain_and_read_noise_are_as_sure_as_stated_over_many_recordings(bench: Bench) -> None:
    # 1 ± 0.1 and 0 ± 0.1 are the promise, four standard errors of 400 recordings come on top.
    assert_covers(scores(bench, range(1000, 1400)), 0.1)


def test_the_noise_line_stands_in_without_darks_and_says_so() -> None:
    bench = replace(TWELVE_BITS, darks=0)
    found = determined(bench, np.random.default_rng(3), Choices(darks_required=False)).coefficients
    told = found.provenance.parameters
    assert told["system_gain_method"] == "noise line"
    assert "no darks" in str(told["system_gain_reason"])
    gain_std = found.system_gain_dn_per_e_std
    assert abs(found.system_gain_dn_per_e - bench.gain) < 4 * gain_std


def test_the_noise_line_stands_in_where_rounding_hides_the_read_noise() -> None:
    found = determined(replace(LITTLE_NOISE, read_dn=0.03), np.random.default_rng(4)).coefficients
    assert "hides it" in str(found.provenance.parameters["system_gain_reason"])
    assert np.isfinite(found.read_noise_e)


def test_a_response_that_bends_is_named_and_does_not_bend_the_gain() -> None:
    rng = np.random.default_rng(5)
    bench = replace(TWELVE_BITS, lines=200)
    drawn = draw(bench, rng, pixels=True).statistics
    beta = 2e-5
    blocks = []
    for s in drawn.fit:
        # Noise and means of a response DN − β·DN², in the DN of its offset.
        light = s.mean_dn - bench.offset_mean
        blocks.append(
            replace(
                s,
                mean_dn=s.mean_dn - beta * (light**2 + s.variance_dn2),
                variance_dn2=(1.0 - 2.0 * beta * light) ** 2 * s.variance_dn2,
            )
        )
    statistics = RecordingStatistics(tuple(blocks))
    found = determine(statistics, bench.header(), Provenance("0" * 64))
    told = found.coefficients.provenance.parameters
    assert told["system_gain_model"] == "nonlinear"
    assert any("curve is nonlinear" in w for w in found.warnings)
    c = found.coefficients
    assert abs(c.system_gain_dn_per_e - bench.gain) < 4 * c.system_gain_dn_per_e_std
