from dataclasses import replace

import numpy as np
import pytest
from numpy.random import default_rng

from calib.errors import InputError
from calib.radiometric.spectral.spectral_response_angles import angular_variation
from calib.radiometric.spectral.spectral_response_scan import SpectralScan
from tests.calib.radiometric.example_scan import (
    ANGLES_DEG,
    WAVELENGTH_NM,
    ExampleScan,
    true_response,
    write_csv,
)

QUIET = ExampleScan(noise_dn=0.0, reading_noise=0.0, photodiode_std=0.0)
SMALL = replace(ExampleScan(), angles_deg=(0.0,))


def test_without_errors_the_response_comes_back_whatever_lamp_drift_and_photodiode(tmp_path):
    scan = SpectralScan.load(QUIET.write(tmp_path, default_rng(1)))
    assert scan.response.shape == (5, len(WAVELENGTH_NM))
    truth = true_response(WAVELENGTH_NM)
    for angle in ANGLES_DEG:
        response = scan.at_angle(angle).response
        np.testing.assert_allclose(response, truth / truth.max(), rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(
    "bench",
    [
        SMALL,
        replace(SMALL, photodiode_std=0.02),
        replace(SMALL, noise_dn=10.0, photodiode_std=0.0, reading_noise=0.0, drift=0.0),
        replace(SMALL, noise_dn=0.1, reading_noise=0.01, drift=0.0),
    ],
    ids=["all", "photodiode", "noise", "readings"],
)
def test_the_response_scatters_as_it_states(tmp_path, bench):
    n = 60
    bench = replace(bench, drift=0.0)
    truth = 2e9 / 200 * true_response(WAVELENGTH_NM)  # DN of signal per W, over 200 us
    z = []
    for rng in default_rng(11).spawn(n):
        scan = SpectralScan.load(bench.write(tmp_path, rng))
        std = np.hypot(scan.std[0], scan.response[0] * scan.photodiode_relative_std)
        z.append((scan.response[0] - truth) / std)
    z = np.array(z)
    assert abs(z.mean()) < 4 / np.sqrt(z.size)
    assert abs(z.std() - 1) < 4 / np.sqrt(2 * z.size)


def test_a_drift_that_is_not_straight_in_time_is_within_the_stated_uncertainty(tmp_path):
    bench = replace(SMALL, noise_dn=0.001, reading_noise=1e-6, photodiode_std=0.0, drift=0.1)
    bench = replace(bench, drift_known=False)
    truth = 2e9 / 200 * true_response(WAVELENGTH_NM)
    n = 400
    z = []
    for rng in default_rng(12).spawn(n):
        scan = SpectralScan.load(bench.write(tmp_path, rng))
        middle = len(WAVELENGTH_NM) // 2
        z.append((scan.response[0, middle] - truth[middle]) / scan.std[0, middle])
        assert scan.largest_drift < 0.1001
    # uniform on +-sqrt(3): its standard deviation is estimated to sqrt((9/5 - 1)/4n)
    assert abs(np.std(z) - 1) < 4 * np.sqrt(0.2 / n)
    assert np.abs(z).max() < np.sqrt(3) * 1.1


def test_angles_that_do_not_differ_are_not_said_to(tmp_path):
    sigmas, shifts, factors = [], [], []
    for rng in default_rng(21).spawn(40):
        scan = SpectralScan.load(replace(ExampleScan(), drift=0.0).write(tmp_path, rng))
        for each in angular_variation(scan):
            sigmas.append(each.significance_sigma)
            shifts.append(each.centroid_shift_nm.value / each.centroid_shift_nm.std)
            true_factor = 1 - 0.01 * abs(each.angle_deg)
            factors.append((each.scale.value - true_factor) / each.scale.std)
            assert each.rms_difference < 2 * each.rms_expected
    for z in (sigmas, shifts, factors):
        # the four comparisons of a scan share the reference angle's noise: 40 independent ones
        assert abs(np.mean(z)) < 4 / np.sqrt(40)
        assert abs(np.std(z) - 1) < 4 / np.sqrt(2 * 40)


@pytest.mark.parametrize("shift_nm", [-1.5, 1.0])
def test_a_band_that_moves_with_the_angle_is_seen(tmp_path, shift_nm):
    bench = ExampleScan(noise_dn=0.3, drift=0.0, shift_nm_at_4_deg=shift_nm)
    found = angular_variation(SpectralScan.load(bench.write(tmp_path, default_rng(22))))
    assert [each.angle_deg for each in found] == [-4, -2, 2, 4]
    for each in found:
        expected = shift_nm * (each.angle_deg / 4) ** 2
        assert abs(each.centroid_shift_nm.value - expected) < 4 * each.centroid_shift_nm.std
    assert found[0].significance_sigma > 10
    assert found[-1].significance_sigma > 10


def test_signals_may_come_as_frames(tmp_path):
    folder = QUIET.write(tmp_path, default_rng(1))
    lines = (folder / "scan.csv").read_text().splitlines()[1:]
    frames = folder / "frames"
    frames.mkdir()
    rows = []
    for number, line in enumerate(lines):
        wavelength, angle, time_s, exposure, signal, _, dark, _ = line.split(",")
        for name, value in (("lit", signal), ("dark", dark)):
            frame = np.full((4, 20), 999.0)
            frame[:, 5:9] = float(value)
            np.save(frames / f"{name}{number}.npy", frame)
        rows.append(
            f"{wavelength},{angle},{time_s},{exposure},lit{number}.npy,dark{number}.npy,5,8"
        )
    expected = SpectralScan.load(folder)
    header = "wavelength_nm,angle_deg,time_s,exposure_us,frame,dark_frame,first_column,last_column"
    write_csv(folder / "scan.csv", header, rows)
    np.testing.assert_allclose(SpectralScan.load(folder).response, expected.response, rtol=1e-9)
    np.save(frames / "lit0.npy", np.ones((4, 6)))
    with pytest.raises(InputError, match=r"lit0\.npy"):
        SpectralScan.load(folder)
    (frames / "lit0.npy").unlink()
    with pytest.raises(InputError, match=r"lit0\.npy is missing"):
        SpectralScan.load(folder)


def test_the_uncertainty_of_a_frame_is_that_of_its_lines(tmp_path):
    folder = replace(QUIET, angles_deg=(0.0,)).write(tmp_path, default_rng(1))
    rows = []
    rng = default_rng(2)
    (folder / "frames").mkdir()
    for number, wavelength in enumerate(WAVELENGTH_NM):
        lines = 100 + 5 * rng.normal(size=(50, 1)) + np.zeros(8)
        np.save(folder / "frames" / f"{number}.npy", lines)
        np.save(folder / "frames" / "dark.npy", np.zeros((2, 8)))
        rows.append(f"{wavelength},0,500,200,{number}.npy,dark.npy,0,7")
    header = "wavelength_nm,angle_deg,time_s,exposure_us,frame,dark_frame,first_column,last_column"
    write_csv(folder / "scan.csv", header, rows)
    scan = SpectralScan.load(folder)
    relative = np.mean(scan.std[0] / scan.response[0])
    drift = np.sqrt(np.mean(scan.drift**2) / 12)
    expected = np.hypot(5 / np.sqrt(50) / 100, drift)
    assert relative == pytest.approx(expected, rel=4 / np.sqrt(2 * 50 * len(rows)))


def _without(folder, name, predicate):
    lines = (folder / name).read_text().splitlines()
    write_csv(folder / name, lines[0], [line for line in lines[1:] if not predicate(line)])


@pytest.mark.parametrize(
    ("name", "dropped", "code"),
    [
        ("scan.csv", lambda line: line.startswith("783.0,2.0,"), "scan-incomplete"),
        ("reference.csv", lambda line: line.startswith("after,-4.0"), "reference-missing"),
        ("reference.csv", lambda line: line.startswith("after,-4.0,750"), "reference-missing"),
        ("photodiode.csv", lambda line: line.startswith("920"), "photodiode-range"),
        ("photodiode.csv", lambda line: line.startswith("750"), "photodiode-range"),
    ],
)  # fmt: skip
def test_what_is_missing_in_a_scan_is_named(tmp_path, name, dropped, code):
    folder = ExampleScan().write(tmp_path, default_rng(1))
    _without(folder, name, dropped if code != "photodiode-range" else _edge(folder, dropped))
    with pytest.raises(InputError) as error:
        SpectralScan.load(folder)
    assert error.value.code == code
    assert name in str(error.value)


def _edge(folder, dropped):
    """The photodiode's last points below or above the scan."""
    low = dropped("750")
    return lambda line: (float(line.split(",")[0]) < 753) if low else line.startswith("918")


@pytest.mark.parametrize(
    ("name", "old", "new", "code"),
    [
        ("reference.csv", "after,", "later,", "bad-when"),
        ("reference.csv", "before,-4.0,750.0,0.0", "before,-4.0,750.0,600.0", "reference-order"),
        ("scan.csv", ",dark_dn,", ",darkness_dn,", "unknown-column"),
        ("scan.csv", "750.0,-4.0,500.0,200", "750.0,-4.0,500.0,0", "out-of-range"),
        ("scan.csv", "753.0,-4.0,", "750.0,-4.0,", "scan-incomplete"),
        ("photodiode.csv", "750.0,0.35", "750.0,-0.35", "out-of-range"),
    ],
)
def test_what_is_wrong_in_a_scan_is_named(tmp_path, name, old, new, code):
    bench = replace(ExampleScan(), photodiode_std=0.0)
    path = bench.write(tmp_path, default_rng(1)) / name
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new, 1))
    with pytest.raises(InputError) as error:
        SpectralScan.load(tmp_path)
    assert error.value.code == code
    assert name in str(error.value) or code == "reference-order"


@pytest.mark.parametrize("name", ["scan.csv", "reference.csv", "photodiode.csv"])
def test_a_missing_file_is_named(tmp_path, name):
    (SMALL.write(tmp_path, default_rng(1)) / name).unlink()
    with pytest.raises(InputError, match=name) as error:
        SpectralScan.load(tmp_path)
    assert error.value.code == "not-found"


def test_an_angle_that_was_not_scanned_is_refused(tmp_path):
    scan = SpectralScan.load(SMALL.write(tmp_path, default_rng(1)))
    with pytest.raises(InputError, match="choose one of 0") as error:
        scan.at_angle(2.0)
    assert error.value.code == "no-such-angle"


def test_readings_without_an_angle_serve_all(tmp_path):
    folder = SMALL.write(tmp_path, default_rng(1))
    expected = SpectralScan.load(folder).response
    text = (folder / "reference.csv").read_text()
    (folder / "reference.csv").write_text(text.replace("before,0.0,", "before,,"))
    np.testing.assert_array_equal(SpectralScan.load(folder).response, expected)
