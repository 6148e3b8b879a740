"""Sets that carry departures: their file, their id, and lines that they correct."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import h5py
import numpy as np
import pytest
from numpy.random import default_rng

from calib.forward.effect import Effect
from calib.forward.effects.catalogue import effect_named
from calib.radiometric.calibrate import calibrate
from calib.radiometric.coefficients.coefficient_metadata import to_metadata
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.correction.apply import Correction
from calib.radiometric.correction.apply_options import ApplyOptions
from calib.radiometric.correction.apply_recording import correct_recording
from calib.radiometric.correction.flags import Flag
from calib.recording.header import Block
from tests.calib.radiometric.departures.cases import MODEL, TEMPERATURES_C, recording
from tests.calib.radiometric.example_set import example_set
from tests.calib.radiometric.in_memory import InMemory, record

LAG = effect_named("lag")(share=0.05)


def carrying(effect: Effect) -> tuple[CoefficientSet, InMemory]:
    model = MODEL.with_effect(effect)
    recorded = recording(model, default_rng())
    return calibrate(recorded, model=model).coefficients, recorded


@pytest.fixture(scope="module")
def lagging() -> tuple[CoefficientSet, InMemory]:
    return carrying(LAG)


def lines_of(found: CoefficientSet, dn: np.ndarray, **more: object) -> np.ndarray:
    return Correction(found, 100.0, camera=found.camera, **more).lines(dn).radiance


def test_a_set_comes_back_from_its_file_with_its_departures(
    lagging: tuple[CoefficientSet, InMemory], tmp_path: Path
) -> None:
    found, recorded = lagging
    found.save(tmp_path / "set.h5")
    loaded = CoefficientSet.load(tmp_path / "set.h5")
    assert loaded.id == found.id
    assert loaded.departures is not None
    assert loaded.departures.departures == (LAG,)
    dn = recorded.stretches["000"][0]
    np.testing.assert_array_equal(lines_of(loaded, dn), lines_of(found, dn))


def test_departures_are_content_and_a_set_without_them_is_as_it_was(
    lagging: tuple[CoefficientSet, InMemory],
) -> None:
    found, _ = lagging
    assert replace(found, departures=None).id != found.id
    plain = example_set()
    assert "departures" not in to_metadata(plain)
    assert Correction(plain, 200.0, camera=plain.camera).inversion is None


def test_a_model_without_departures_calibrates_as_none_does() -> None:
    recorded = recording(MODEL, default_rng())
    with_model = calibrate(recorded, model=MODEL)
    assert with_model.coefficients.id == calibrate(recorded).coefficients.id
    assert "no departure" in with_model.warnings[0]


def test_lines_are_corrected_alike_however_they_are_cut(
    lagging: tuple[CoefficientSet, InMemory],
) -> None:
    found, recorded = lagging
    dn = recorded.stretches["004"][0]
    whole = lines_of(found, dn)
    correction = Correction(found, 100.0, camera=found.camera)
    parts = [correction.lines(part).radiance for part in (dn[:1], dn[1:20], dn[20:])]
    # Both stop within SETTLED_DN of the light that is looked for; 0.45 DN per radiance us.
    np.testing.assert_allclose(np.concatenate(parts), whole, atol=4e-3 / (0.2 * 100.0))


def test_what_a_block_leaves_is_taken_from_the_next_one_even_where_it_is_not_asked_for(
    tmp_path: Path,
) -> None:
    found, _ = carrying(LAG)
    model, lines = MODEL.with_effect(LAG), 64
    blocks = [
        Block(block=name, kind="flat", exposure_us=100.0, level=level, lines=lines)
        for name, level in (("bright", 6), ("dim", 1))
    ]
    seen = record(model, blocks, default_rng(), lines)
    correct_recording(seen, found, tmp_path / "both.h5")
    with h5py.File(tmp_path / "both.h5") as file:
        both = file["blocks/dim/radiance"][:]
    dim_only = InMemory(seen.header, seen.stretches)
    correct_recording(dim_only, found, tmp_path / "dim.h5", options=ApplyOptions(blocks=["dim"]))
    with h5py.File(tmp_path / "dim.h5") as file:
        assert list(file["blocks"]) == ["dim"]
        np.testing.assert_array_equal(file["blocks/dim/radiance"][:], both)
    first, others = both[0].astype(float), both[1:].astype(float)
    error = others.std(axis=0, ddof=1)
    # The bright block leaves 5 % of 60 in the first line of 10: 30 % of it.
    z = (first - others.mean(axis=0)) / error
    assert abs(z.mean()) < 5.0 / np.sqrt(z.size)
    plain = lines_of(found, seen.stretches["dim"][0])
    assert plain[0].mean() - plain[1:].mean() > 2.0


def test_what_only_the_bench_did_is_not_taken_out_of_lines() -> None:
    found, recorded = carrying(effect_named("lamp_drift")(amplitude=0.05, time_constant_s=0.5))
    dn = recorded.stretches["000"][0]
    plain = lines_of(replace(found, departures=None), dn)
    # Single precision of the kernel against double.
    np.testing.assert_allclose(lines_of(found, dn), plain, rtol=1e-5, atol=1e-5)


def test_an_unknown_time_or_temperature_is_said_and_taken_from_the_calibration() -> None:
    found, _ = carrying(effect_named("offset_temperature")(dn_per_k=2.0))
    dn = np.full((4, found.n_columns), 900, np.uint16)
    loose = Correction(found, 100.0, camera=found.camera)
    assert any("temperature is not known: offset_temperature" in note for note in loose.notes)
    usual = float(np.mean([TEMPERATURES_C[k % 6] for k in (0, 2, 4, 6, 8, 10, 11, 12, 13, 14, 15)]))
    told = Correction(found, 100.0, camera=found.camera, sensor_temperature_c=usual)
    assert not any("temperature" in note for note in told.notes)
    np.testing.assert_array_equal(loose.lines(dn).radiance, told.lines(dn).radiance)
    warmer = Correction(found, 100.0, camera=found.camera, sensor_temperature_c=usual + 1.0)
    step = (told.lines(dn).radiance - warmer.lines(dn).radiance) / told.terms.scale
    np.testing.assert_allclose(step, 2.0, rtol=1e-3)


def test_a_drift_goes_by_the_time_since_the_calibration() -> None:
    drift = effect_named("offset_drift")(amplitude_dn=10.0, time_constant_s=100.0)
    found, _ = carrying(drift)
    dn = np.full((1, found.n_columns), 900, np.uint16)
    started = datetime(2026, 11, 1, tzinfo=UTC)
    at_start, later = (
        Correction(found, 100.0, camera=found.camera, at=started + timedelta(seconds=s))
        for s in (0.0, 100.0)
    )
    step = (at_start.lines(dn).radiance - later.lines(dn).radiance) / later.terms.scale
    np.testing.assert_allclose(step, 10.0 * (1.0 - np.exp(-1.0)), rtol=1e-3)
    unknown = found.camera.model_copy(update={"started_at": None})
    assert any("offset_drift" in note for note in Correction(found, 100.0, camera=unknown).notes)


def test_a_code_that_no_light_makes_is_as_good_as_saturated() -> None:
    knee = effect_named("saturation_knee")(
        threshold_e=30_000.0, room_e=30_000.0, relative_spread=0.0
    )
    found, _ = carrying(knee)
    # At most (30,000 + 30,000) e- x 0.05 DN/e- + 40 DN: 3,040.
    dn = np.full((1, found.n_columns), 3300, np.uint16)
    lines = Correction(found, 100.0, camera=found.camera).lines(dn)
    assert (lines.flags & Flag.SATURATED).all()
    assert lines.std is not None
    assert np.isinf(lines.std).all()
    below = Correction(found, 100.0, camera=found.camera).lines(dn - 1800)
    assert not (below.flags & Flag.SATURATED).any()
