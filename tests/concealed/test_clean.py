"""What a recording with nothing hidden is, from first principles."""

import numpy as np
import pytest

from tests.concealed.generator.answer import take_case
from tests.concealed.generator.case import Case, Hidden
from tests.concealed.generator.chain import TakenBlock


def clean(seed: int) -> Case:
    return Case(0, "clean", (), seed, 200_000)


def flats(case: Case) -> list[TakenBlock]:
    return [block for block in take_case(case)[0] if block.plan.kind == "flat"]


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_means_are_offset_plus_gain_times_electrons(seed: int) -> None:
    case = clean(seed)
    sensor, z = case.setting.sensor, []
    for block in flats(case):
        light = block.plan.radiance * block.plan.exposure_us * sensor.electrons_per_radiance_us
        electrons = light * sensor.relative_response
        gain = sensor.gain_dn_per_e
        expected = sensor.offset_dn + gain * electrons
        variance = gain**2 * (electrons + sensor.read_noise_e**2) + 1 / 12
        n = block.codes.shape[0]
        z.append(((block.codes.mean(axis=0) - expected) / np.sqrt(variance / n)).ravel())
    # Half a DN of noise leaves of rounding's bias what is far below the mean's standard error.
    every = np.concatenate(z)
    assert abs(every.mean()) < 4 / np.sqrt(every.size)
    assert abs(every.std() - 1) < 4 / np.sqrt(2 * every.size)


@pytest.mark.parametrize("seed", [5, 6, 7, 8])
def test_variance_to_mean_ratio_is_the_system_gain(seed: int) -> None:
    case = clean(seed)
    sensor, z = case.setting.sensor, []
    for block in flats(case):
        codes = block.codes.astype(float)
        gain = sensor.gain_dn_per_e
        signal = codes.mean(axis=0) - sensor.offset_dn
        floor = (gain * sensor.read_noise_e) ** 2 + 1 / 12
        expected = (gain * signal + floor).sum()
        spread = np.sqrt(2 / (len(codes) - 1) * ((gain * signal + floor) ** 2).sum())
        z.append((codes.var(axis=0, ddof=1).sum() - expected) / spread)
    assert abs(np.mean(z)) < 4 / np.sqrt(len(z))
    assert np.std(z) < 1 + 4 / np.sqrt(2 * len(z))


def test_the_same_seed_gives_the_same_recording_and_another_one_another() -> None:
    first, again, other = (take_case(clean(seed))[0] for seed in (9, 9, 10))
    assert all(np.array_equal(a.codes, b.codes) for a, b in zip(first, again, strict=True))
    assert not np.array_equal(first[0].codes, other[0].codes)


def test_what_is_hidden_changes_neither_sensor_nor_plan() -> None:
    hidden = Case(0, "single", (Hidden("line_noise", "gaussian", 1.0),), 11, 200_000)
    assert hidden.setting.plan == clean(11).setting.plan
    np.testing.assert_array_equal(
        hidden.setting.sensor.offset_dn, clean(11).setting.sensor.offset_dn
    )
