from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
import pytest
from numpy.random import default_rng

from calib.errors import InputError
from calib.radiometric.coefficients.provenance import Domain
from calib.radiometric.correction.apply import Correction
from calib.radiometric.correction.apply_checks import Validity
from calib.radiometric.correction.flags import Flag, count_flags
from calib.radiometric.correction.radiance_lines import Radiance
from calib.radiometric.correction.transmittance import DESTINY_NIR, Window
from tests.calib.radiometric.example_set import example_set

SET = example_set()
NOVEMBER = Validity(datetime(2026, 11, 1, tzinfo=UTC), datetime(2026, 12, 1, tzinfo=UTC))
DEAD = 3


def correction(coefficients=SET, exposure_us=200.0, **options) -> Correction:
    return Correction(coefficients, exposure_us, camera=coefficients.camera, **options)


def flat(code, n_lines=2, n_columns=32):
    return np.full((n_lines, n_columns), code, np.uint16)


def test_radiance_is_what_the_equation_says():
    dn = default_rng(1).integers(100, 3000, (4, 32)).astype(np.uint16)
    expected = (dn - SET.dark_offset_dn) / (SET.vignette * SET.responsivity * 200.0)
    result = correction().lines(dn).radiance
    assert result.dtype == np.float32
    np.testing.assert_allclose(result, expected, rtol=1e-6)


def test_dark_current_is_taken_off_in_proportion_to_the_exposure():
    warm = example_set(dark_current_dn_per_us=np.full(32, 0.05))
    np.testing.assert_allclose(
        correction(warm).lines(flat(1000)).radiance, correction().lines(flat(990)).radiance
    )


def test_the_radiance_is_that_in_front_of_the_window():
    bare = correction().lines(flat(1000))
    behind = correction(window=DESTINY_NIR).lines(flat(1000))
    np.testing.assert_allclose(behind.radiance, bare.radiance / 0.934, rtol=1e-6)


def test_the_windows_uncertainty_adds_to_the_scales():
    window = Window(0.5, 0.5 * 0.02)
    coefficients = example_set(slope_std=np.zeros(32), offset_slope_covariance=np.zeros(32))
    bare, behind = (correction(coefficients, window=w).lines(flat(1000)) for w in (None, window))
    relative = [(each.std / each.radiance) ** 2 for each in (bare, behind)]
    good = coefficients.valid
    np.testing.assert_allclose((relative[1] - relative[0])[:, good], 0.02**2, rtol=1e-4)


@pytest.mark.parametrize(
    ("code", "flag", "others"),
    [
        (4095, Flag.SATURATED, Flag.EXTRAPOLATED),
        (29, Flag.BELOW_BLACK, Flag.EXTRAPOLATED),
        (0, Flag.BELOW_BLACK, Flag.EXTRAPOLATED),
        (3990, Flag.EXTRAPOLATED, Flag(0)),
        (3, Flag.EXTRAPOLATED, Flag.BELOW_BLACK),
        (1000, Flag(0), Flag(0)),
    ],
)
def test_a_code_raises_its_flags_and_no_others(code, flag, others):
    flags = correction().lines(flat(code)).flags
    good = SET.valid
    assert set(np.unique(flags[:, good])) == {int(flag | others)}
    assert set(np.unique(flags[:, ~good] & Flag.MASKED)) == {int(Flag.MASKED)}


def test_noise_about_the_brightest_calibrated_code_is_not_extrapolated():
    highest = int(SET.domain.dn[1])
    noise = np.sqrt(0.1 * (highest - 30) + (0.1 * 20) ** 2 + 1 / 12)
    for code, extrapolated in ((highest + 2 * noise, False), (highest + 4 * noise, True)):
        flags = correction().lines(flat(int(code))).flags[0, 0]
        assert bool(flags & Flag.EXTRAPOLATED) is extrapolated


def test_a_masked_column_is_nan_and_never_interpolated():
    result = correction().lines(flat(1000))
    assert np.isnan(result.radiance[:, DEAD]).all()
    assert np.isnan(result.std[:, DEAD]).all()
    assert np.isfinite(result.radiance[:, SET.valid]).all()


def test_a_saturated_sample_is_a_bound_without_a_finite_uncertainty():
    result = correction().lines(flat(4095))
    assert np.isposinf(result.std[:, SET.valid]).all()
    assert np.isfinite(result.radiance[:, SET.valid]).all()


def test_below_black_the_radiance_stays_negative():
    assert (correction().lines(flat(20)).radiance[:, SET.valid] < 0).all()


@pytest.mark.parametrize(
    "change",
    [{"serial": "B0002"}, {"serial": ""}, {"band": "red"}, {"gain_db": 6.0}, {"bit_depth": 10},
     {"black_level_dn": 8.0}],
)  # fmt: skip
def test_another_camera_is_refused_unless_forced_and_then_the_output_says_so(change):
    camera = SET.camera.model_copy(update=change)
    with pytest.raises(InputError, match=next(iter(change))) as error:
        Correction(SET, 200.0, camera=camera)
    assert error.value.code == "set-mismatch"
    forced = Correction(SET, 200.0, camera=camera, force=True)
    assert next(iter(change)) in forced.notes[0]
    assert (forced.lines(flat(1000)).flags & Flag.MISMATCHED).all()


def test_other_columns_of_the_same_sensor_are_refused():
    camera = SET.camera.model_copy(update={"first_column": 64})
    with pytest.raises(InputError, match=f"region is '0:{SET.n_columns}' in the set") as error:
        Correction(SET, 200.0, camera=camera)
    assert error.value.code == "set-mismatch"


def test_two_spellings_of_a_gain_are_one():
    camera = SET.camera.model_copy(update={"gain_db": SET.camera.gain_db + 1e-9})
    assert Correction(SET, 200.0, camera=camera).notes == ()


@pytest.mark.parametrize(
    ("at", "validity", "refused"),
    [
        (datetime(2026, 11, 15, tzinfo=UTC), NOVEMBER, False),
        (datetime(2026, 11, 15), NOVEMBER, False),
        (NOVEMBER.valid_from, NOVEMBER, False),
        (NOVEMBER.valid_until, NOVEMBER, True),
        (datetime(2026, 12, 2, tzinfo=UTC), NOVEMBER, True),
        (datetime(2026, 10, 2, tzinfo=UTC), Validity(valid_from=NOVEMBER.valid_from), True),
        (datetime(2027, 10, 2, tzinfo=UTC), Validity(valid_from=NOVEMBER.valid_from), False),
        (None, NOVEMBER, True),
        (None, None, False),
        (None, Validity(), False),
    ],
)
def test_validity_is_asked_of_the_lines_time(at, validity, refused):
    if not refused:
        made = correction(at=at, validity=validity)
    else:
        with pytest.raises(InputError) as error:
            correction(at=at, validity=validity)
        assert error.value.code == "outside-validity"
        made = correction(at=at, validity=validity, force=True)
    flagged = (made.lines(flat(1000)).flags & Flag.OUTSIDE_VALIDITY).astype(bool)
    assert flagged.all() == flagged.any() == refused


@pytest.mark.parametrize(
    ("options", "extrapolated"),
    [
        ({"exposure_us": 500.0}, False),
        ({"exposure_us": 600.0}, True),
        ({"exposure_us": 50.0}, True),
        ({"sensor_temperature_c": 26.5}, False),
        ({"sensor_temperature_c": 40.0}, True),
    ],
)
def test_conditions_that_were_not_calibrated_flag_every_sample(options, extrapolated):
    made = correction(**options)
    flagged = (made.lines(flat(1000)).flags & Flag.EXTRAPOLATED).astype(bool)
    assert flagged.all() == flagged.any() == extrapolated == bool(made.notes)


@pytest.mark.parametrize(
    ("dn", "code"),
    [
        (np.zeros((2, 31), np.uint16), "wrong-shape"),
        (np.zeros(32, np.uint16), "wrong-shape"),
        (np.zeros((0, 32), np.uint16), "wrong-shape"),
        (np.zeros((2, 32), np.float32), "wrong-dtype"),
        (np.zeros((2, 32), np.int16), "wrong-dtype"),
    ],
)
def test_lines_that_are_none_are_refused(dn, code):
    with pytest.raises(InputError) as error:
        correction().lines(dn)
    assert error.value.code == code


@pytest.mark.parametrize("exposure_us", [0.0, -1.0, np.nan, np.inf, 7.8e-209, 1e13])
def test_an_exposure_must_be_one_that_light_is_taken_with(exposure_us):
    with pytest.raises(InputError) as error:
        correction(exposure_us=exposure_us)
    assert error.value.code == "bad-exposure"


def test_another_number_of_columns_cannot_be_forced():
    camera = SET.camera.model_copy(update={"columns": 31})
    with pytest.raises(InputError) as error:
        Correction(SET, 200.0, camera=camera, force=True)
    assert error.value.code == "wrong-columns"


def test_given_arrays_are_filled_and_lines_left_alone():
    dn = np.asfortranarray(flat(1000))
    dn.flags.writeable = False
    out = Radiance.empty(2, 32)
    assert correction().lines(dn, out=out) is out
    fresh = correction().lines(dn)
    np.testing.assert_array_equal(out.radiance, fresh.radiance)
    np.testing.assert_array_equal(out.std, fresh.std)


@pytest.mark.parametrize(
    "out",
    [Radiance.empty(3, 32), replace(Radiance.empty(2, 32), std=np.empty((1, 32), np.float32)),
     replace(Radiance.empty(2, 32), flags=np.empty((2, 16), np.uint8))],
)  # fmt: skip
def test_arrays_of_another_shape_are_not_written_to(out):
    with pytest.raises(InputError) as error:
        correction().lines(flat(1000), out=out)
    assert error.value.code == "wrong-shape"


def test_flags_are_counted_by_name():
    counts = count_flags(np.array([0, 1, 5, 4, 40], np.uint8))
    assert counts == {
        "saturated": 2, "below_black": 0, "masked": 2,
        "extrapolated": 1, "outside_validity": 0, "mismatched": 1,
    }  # fmt: skip


def test_a_set_that_has_seen_all_codes_extrapolates_none():
    wide = example_set(domain=Domain((100.0, 500.0), (0.0, 4095.0), (0.0, 90.0)))
    dn = np.repeat(np.arange(4096, dtype=np.uint16)[:, None], 32, axis=1)
    assert not (correction(wide).lines(dn).flags & Flag.EXTRAPOLATED).any()


@pytest.mark.parametrize("values", [(0.0, 0.0), (1.1, 0.0), (0.9, -0.1), (0.9, 1.0), (np.nan, 0)])
def test_a_window_without_a_possible_transmittance_is_refused(values):
    with pytest.raises(InputError) as error:
        Window(*values)
    assert error.value.code == "transmittance-out-of-range"


def test_a_source_behind_a_window_is_dimmer_by_its_transmittance():
    assert Window(0.5, 0.0).behind(10.0, 1.0) == (5.0, 0.5)
    assert Window(0.5, 0.05).behind(10.0) == (5.0, pytest.approx(0.5))
