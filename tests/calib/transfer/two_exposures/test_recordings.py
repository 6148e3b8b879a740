"""From a recording to maps: blocks chosen, preconditions tested, the file written."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from calib.errors import DarkflatError, NotDeterminedError
from calib.recording.statistics import CancelledError
from calib.transfer.two_exposures.exposure_pair import ExposureMoments
from calib.transfer.two_exposures.pixel_state import PixelState
from calib.transfer.two_exposures.static_scene import pattern_change
from calib.transfer.two_exposures.two_exposures import TwoExposures, two_exposure_moments
from tests.calib.transfer.two_exposures.stacks import (
    InMemory,
    RawLines,
    Sensor,
    Shot,
    accumulated,
    recording_of,
)

SEVERAL = 4.0  # standard errors
T = 1000.0
SENSOR = Sensor.flat(24 * 32, 3000.0, 6.0)
ROWS = (24, 32)


def stack(n: int, key: int, light: Any = 1.0, sensor: Sensor = SENSOR) -> RawLines:
    """n frames of an area sensor."""
    return sensor.frames(n, key, light).reshape(n, *ROWS)


def two_flats(n: int = 40, **options: Any) -> InMemory:
    shots = [Shot(stack(n, 1), T), Shot(stack(n, 2, 2.0), 2 * T)]
    return recording_of(shots, **options)


def codes_of(result: TwoExposures) -> list[str]:
    return [finding.code for finding in result.findings]


def refusal(recording: InMemory, method: Any = "sanuc") -> str:
    with pytest.raises(NotDeterminedError) as refused:
        two_exposure_moments(recording, method)
    return refused.value.code


@pytest.mark.parametrize("stretch", [1, 5, 8, 40])
def test_an_area_stack_gives_the_same_however_it_is_read(stretch: int) -> None:
    result = two_exposure_moments(two_flats(stretch=stretch))
    wanted = two_exposure_moments(two_flats(stretch=16))
    for name in ("system_gain_dn_per_e", "bias_dn", "photoelectrons", "read_noise_variance_dn2"):
        assert np.array_equal(
            getattr(result.maps, name), getattr(wanted.maps, name), equal_nan=True
        )
    true = {"system_gain_dn_per_e": 1.0, "photoelectrons": 3000.0, "read_noise_variance_dn2": 36.0}
    for name, value in true.items():
        estimate = getattr(result.pooled, name)
        assert abs(estimate.value - value) < SEVERAL * estimate.std, name
    assert codes_of(result) == ["few-frames"]


def test_a_line_sensor_is_read_in_lines() -> None:
    shots = [Shot(SENSOR.frames(200, 1), T), Shot(SENSOR.frames(200, 2, 2.0), 2 * T)]
    result = two_exposure_moments(recording_of(shots, stretch=60))
    assert result.shape == (768,)
    assert (
        abs(result.pooled.bias_dn.value - SENSOR.bias.mean()) < SEVERAL * result.pooled.bias_dn.std
    )
    assert result.findings == ()


def test_s3nuc_takes_any_two_exposures_and_sanuc_does_not() -> None:
    shots = [Shot(stack(40, 1), T), Shot(stack(40, 2, 3.0), 3 * T)]
    recording = recording_of(shots)
    assert refusal(recording) == "not-doubled"
    result = two_exposure_moments(recording, "s3nuc")
    step = result.pooled.photoelectrons_step
    assert abs(step.value - 6000.0) < SEVERAL * step.std


def test_one_exposure_is_refused() -> None:
    shots = [Shot(stack(10, 1), T), Shot(stack(10, 2, 2.0), 2 * T, level=2.0)]
    assert refusal(recording_of(shots)) == "two-flats-missing"


def test_two_frames_are_refused() -> None:
    assert refusal(two_flats(n=2)) == "few-frames"


def test_repeats_are_merged_about_their_own_means() -> None:
    # The lamp is 5 % brighter in the repeats: that is no noise.
    shots = [
        Shot(stack(40, 1), T),
        Shot(stack(40, 2, 2.0), 2 * T),
        Shot(stack(40, 3, 1.05), T),
        Shot(stack(40, 4, 2.1), 2 * T),
    ]
    result = two_exposure_moments(recording_of(shots))
    assert [b.block for b in result.choice.second] == ["001", "003"]
    assert (result.pair.first.n_frames, result.pair.first.n_free) == (80, 78)
    read, gain = result.pooled.read_noise_variance_dn2, result.pooled.system_gain_dn_per_e
    assert abs(read.value - 36.0) < SEVERAL * read.std
    assert abs(gain.value - 1.0) < SEVERAL * gain.std
    lamp = 0.05 * 3000 / 2  # its variance over the blocks would be this squared
    assert lamp**2 > 2 * SEVERAL * read.std


def test_the_brightest_scene_that_does_not_clip_is_taken() -> None:
    sensor = replace(SENSOR, full_scale_dn=16383)
    scenes = [(1.0, 1.0), (4.0, 4.0), (0.5, 0.5)]  # light, level
    shots = []
    for light, level in scenes:
        for times in (1, 2):
            frames = stack(20, 10 * int(2 * light) + times, times * light, sensor)
            shots.append(Shot(frames, times * T, level=level))
    result = two_exposure_moments(recording_of(shots, bit_depth=14))
    assert result.choice.scene == "flats of level 1"
    assert refusal(recording_of(shots[2:4], bit_depth=14)) == "clipped"


def test_the_ratio_is_taken_as_read_back_and_told() -> None:
    shots = [Shot(stack(200, 1), T), Shot(stack(200, 2, 1.97), 1.97 * T)]
    result = two_exposure_moments(recording_of(shots))
    assert codes_of(result) == ["not-doubled"]
    bias, true = result.pooled.bias_dn, SENSOR.bias.mean()
    assert abs(bias.value - true) < SEVERAL * bias.std
    assert 2 * SEVERAL * bias.std < 0.03 * 3000  # a ratio of 2 would be seen


@pytest.mark.parametrize(("change", "severity"), [(1.01, "warning"), (1.2, "refusal")])
def test_a_lamp_that_changed_is_seen_by_the_monitor(change: float, severity: str) -> None:
    shots = [
        Shot(stack(100, 1), T, more={"monitor": 1e-9}),
        Shot(stack(100, 2, 2.0 * change), 2 * T, more={"monitor": change * 1e-9}),
    ]
    recording = recording_of(shots)
    if severity == "refusal":
        assert refusal(recording) == "not-doubled"
    else:
        (finding,) = two_exposure_moments(recording).findings
        assert (finding.code, finding.severity) == ("not-doubled", "warning")
        assert finding.figure == pytest.approx(2.02)


def test_a_drifting_lamp_is_told_and_a_strongly_drifting_one_refused() -> None:
    def drifting(share: float) -> InMemory:
        light = 1 + share * np.linspace(-0.5, 0.5, 100)
        return recording_of([Shot(stack(100, 1), T), Shot(stack(100, 2, 2 * light), 2 * T)])

    assert codes_of(two_exposure_moments(drifting(0.0))) == []
    (finding,) = two_exposure_moments(drifting(0.003)).findings
    assert finding.code == "scene-moved"
    assert finding.figure == pytest.approx(0.003 * 6000, abs=5.0)
    assert refusal(drifting(0.08)) == "scene-moved"


def test_a_picture_that_moves_is_refused_although_its_mean_stays() -> None:
    place = np.linspace(0.0, 6 * np.pi, SENSOR.gain.size)

    def frames(key: int, scale: float, shift: float) -> RawLines:
        parts = []
        for k, n in enumerate((8, 32)):
            light = SENSOR.electrons * (1 + 0.2 * np.sin(place + shift * k))
            sensor = replace(SENSOR, electrons=light)
            parts.append(stack(n, 10 * key + k, scale, sensor))
        return np.concatenate(parts)

    still = recording_of([Shot(frames(1, 1.0, 0.0), T), Shot(frames(2, 2.0, 0.0), 2 * T)])
    moved = recording_of([Shot(frames(1, 1.0, 0.3), T), Shot(frames(2, 2.0, 0.3), 2 * T)])
    assert codes_of(two_exposure_moments(still)) == ["few-frames"]
    assert refusal(moved) == "scene-moved"


def test_a_lamp_that_changes_is_no_change_of_the_picture() -> None:
    place = np.linspace(0.0, 6 * np.pi, SENSOR.gain.size)
    sensor = replace(SENSOR, electrons=SENSOR.electrons * (1 + 0.5 * np.sin(place)))
    done = accumulated(sensor.frames(8, 1))
    early = done.sums.codes.copy()
    for factor in (1.0, 1.02):
        done.add(sensor.frames(32, 2, factor))
        moments = ExposureMoments.of(done.sums)
        still = replace(moments, variance_dn2=sensor.electrons + 36.0)
        change = pattern_change("000", done.sums.codes, early, still)
        assert abs(change.mean_square_dn2) < SEVERAL * change.std_dn2
    assert SEVERAL * change.std_dn2 < (0.01 * 3000 * 0.35) ** 2  # were the factor not fitted


def test_a_bent_response_and_darks_that_disagree_are_told() -> None:
    dark = replace(SENSOR, electrons=np.zeros(768))
    shots = [
        Shot(stack(100, 1), T),
        Shot(stack(100, 2, 2.0), 2 * T),
        Shot(stack(20, 3, 0.5), T / 2),
        Shot(stack(20, 4, 1.0, dark), T, kind="dark"),
    ]
    assert codes_of(two_exposure_moments(recording_of(shots))) == []
    shots[2] = Shot(stack(20, 3, 0.55), T / 2)
    (finding,) = two_exposure_moments(recording_of(shots)).findings
    assert (finding.code, finding.severity) == ("not-linear", "warning")
    assert finding.figure == pytest.approx(0.05 * 3000, abs=5.0)
    shots[2] = Shot(stack(20, 3, 0.5), T / 2)
    shots[3] = Shot(stack(20, 4, 1.0, dark) + np.uint16(60), T, kind="dark")
    (finding,) = two_exposure_moments(recording_of(shots)).findings
    assert "darks" in finding.text
    assert finding.figure == pytest.approx(60.0, abs=3.0)


def test_clipped_pixels_are_left_out_and_told_and_too_many_refused() -> None:
    def clipped(share: float) -> InMemory:
        second = stack(100, 2, 2.0).copy()
        second.reshape(100, -1)[3, : int(share * 768)] = 65535
        return recording_of([Shot(stack(100, 1), T), Shot(second, 2 * T)])

    result = two_exposure_moments(clipped(0.1))
    (finding,) = result.findings
    assert finding.code == "clipped"
    assert finding.figure == pytest.approx(0.1, abs=0.002)
    assert result.pooled.n_pixels == 768 - 76
    assert result.maps.counts()["clipped_at_full_scale"] == 76
    assert refusal(clipped(0.6)) == "clipped"


def test_taps_are_told_one_by_one() -> None:
    gain = np.where(np.arange(768).reshape(ROWS)[:, :] % 2 == 0, 0.5, 0.8).ravel()
    sensor = replace(SENSOR, gain=gain)
    shots = [Shot(stack(100, 1, 1.0, sensor), T), Shot(stack(100, 2, 2.0, sensor), 2 * T)]
    result = two_exposure_moments(recording_of(shots, taps=2, tap_layout="odd_even"))
    for tap, true in zip(result.per_tap, (0.5, 0.8), strict=True):
        assert tap is not None
        assert tap.n_pixels == 384
        estimate = tap.system_gain_dn_per_e
        assert abs(estimate.value - true) < SEVERAL * estimate.std
        assert 2 * SEVERAL * estimate.std < 0.3
    mean = result.pooled.system_gain_dn_per_e
    assert abs(mean.value - 0.65) < SEVERAL * mean.std


def test_progress_runs_to_the_end_and_cancelling_stops() -> None:
    shares: list[float] = []
    two_exposure_moments(two_flats(), progress=shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    asked = iter([False, False, False, True])
    with pytest.raises(CancelledError):
        two_exposure_moments(two_flats(), cancelled=lambda: next(asked))


def test_the_answer_is_json_and_names_what_it_rests_on() -> None:
    result = two_exposure_moments(two_flats(n=100))
    answer = json.loads(json.dumps(result.answer(), allow_nan=False))
    assert answer["method"] == "sanuc"
    assert answer["blocks"] == {"first": ["000"], "second": ["001"]}
    assert answer["system_gain_dn_per_e"]["unit"] == "DN/e-"
    assert answer["read_noise_e"]["std"] > 0
    assert answer["pixels"] == sum(answer["pixel_states"].values()) == 768


def test_maps_are_written_as_images_with_reasons(tmp_path: Path) -> None:
    result = two_exposure_moments(two_flats(n=30))
    path = tmp_path / "MAPS.h5"
    identity = result.save(path)
    with h5py.File(path) as file:
        assert file.attrs["id"] == identity
        for name in (
            "system_gain_dn_per_e",
            "bias_dn",
            "photoelectrons",
            "read_noise_variance_dn2",
        ):
            assert file[name].shape == file[name + "_std"].shape == ROWS
        assert np.array_equal(file["bias_dn"][()].ravel(), result.maps.bias_dn)
        reason = file["reason"][()]
        unknown = np.isnan(file["photoelectrons"][()])
        assert np.array_equal(unknown, reason != PixelState.VALID)
        codes = json.loads(file["metadata_json"].asstr()[()])["reason_codes"]
        assert codes["no_shot_noise"] == PixelState.NO_SHOT_NOISE


def test_maps_are_written_whole_or_not_at_all(tmp_path: Path) -> None:
    result = two_exposure_moments(two_flats(n=10))
    with pytest.raises(DarkflatError) as refused:
        result.save(tmp_path / "missing" / "MAPS.h5")
    assert refused.value.code == "cannot-write"
    assert list(tmp_path.iterdir()) == []
