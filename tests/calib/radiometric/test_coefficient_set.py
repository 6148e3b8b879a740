from pathlib import Path

import h5py
import numpy as np
import pytest

from calib.errors import InputError
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from tests.calib.radiometric.example_set import example_set


def test_a_set_comes_back_from_its_file_as_it_was(tmp_path: Path) -> None:
    saved = example_set(axis_column_std=None, reduced_chi_squared=None)
    saved.save(tmp_path / "set.h5")
    loaded = CoefficientSet.load(tmp_path / "set.h5")
    assert loaded.id == saved.id
    for name in CoefficientSet.array_names():
        np.testing.assert_array_equal(getattr(loaded, name), getattr(saved, name))
    for name in ("camera", "domain", "budget", "provenance", "axis_column", "axis_column_std"):
        assert getattr(loaded, name) == getattr(saved, name)
    assert [p.name for p in tmp_path.iterdir()] == ["set.h5"]


def test_a_scalar_that_is_not_known_stays_unknown(tmp_path: Path) -> None:
    example_set(read_noise_e_std=float("nan")).save(tmp_path / "set.h5")
    assert np.isnan(CoefficientSet.load(tmp_path / "set.h5").read_noise_e_std)


def test_the_id_is_of_the_content_and_not_of_the_file(tmp_path: Path) -> None:
    example_set().save(tmp_path / "a.h5")
    example_set().save(tmp_path / "b.h5")
    with h5py.File(tmp_path / "b.h5", "r+") as file:
        column = file["slope"][()]
        del file["slope"]
        file.create_dataset("slope", data=column, chunks=True, compression="gzip")
    ids = {CoefficientSet.load(tmp_path / name).id for name in ("a.h5", "b.h5")}
    assert ids == {example_set().id}


@pytest.mark.parametrize(
    "changes",
    [
        {"slope": np.nextafter(example_set().slope, 1.0)},
        {"reason": np.zeros(32, np.uint8)},
        {"axis_column": 15.500001},
        {"radiance_unit": "W m-2 sr-1 um-1"},
    ],
    ids=lambda c: next(iter(c)),
)
def test_the_id_changes_with_whatever_changes(changes: dict[str, object]) -> None:
    assert example_set(**changes).id != example_set().id


def test_a_set_from_before_the_region_was_recorded_keeps_its_id(tmp_path: Path) -> None:
    camera = example_set().camera
    assert (camera.first_column, camera.sensor_columns) == (0, None)
    assert not {"first_column", "first_row", "sensor_columns"} & camera.content().keys()
    elsewhere = example_set(camera=camera.model_copy(update={"first_column": 512}))
    assert elsewhere.id != example_set().id
    elsewhere.save(tmp_path / "set.h5")
    assert CoefficientSet.load(tmp_path / "set.h5").camera.first_column == 512


@pytest.mark.parametrize("name", ["dark_offset_dn", "responsivity_std", "valid", "reason"])
def test_an_altered_array_is_refused(tmp_path: Path, name: str) -> None:
    path = tmp_path / "set.h5"
    example_set().save(path)
    with h5py.File(path, "r+") as file:
        file[name][5] = file[name][5] + 1
    with pytest.raises(InputError, match="altered") as refusal:
        CoefficientSet.load(path)
    assert refusal.value.code == "altered"


def test_an_altered_attribute_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "set.h5"
    example_set().save(path)
    with h5py.File(path, "r+") as file:
        file.attrs["axis_column"] = 3.0
    with pytest.raises(InputError, match="altered"):
        CoefficientSet.load(path)


@pytest.mark.parametrize("damage", ["empty", "text", "truncated", "other-hdf5"])
def test_what_is_not_a_set_is_refused_in_one_sentence(tmp_path: Path, damage: str) -> None:
    path = tmp_path / "set.h5"
    example_set().save(path)
    match damage:
        case "empty":
            path.write_bytes(b"")
        case "text":
            path.write_text("coefficients")
        case "truncated":
            path.write_bytes(path.read_bytes()[:3000])
        case "other-hdf5":
            with h5py.File(path, "w") as file:
                file["frames"] = np.zeros(3)
    with pytest.raises(InputError) as refusal:
        CoefficientSet.load(path)
    assert refusal.value.code == "not-a-coefficient-set"
    assert "\n" not in str(refusal.value)


def test_a_missing_file_and_a_missing_folder_are_said(tmp_path: Path) -> None:
    with pytest.raises(InputError) as refusal:
        CoefficientSet.load(tmp_path / "set.h5")
    assert refusal.value.code == "not-found"
    with pytest.raises(InputError) as refusal:
        example_set().save(tmp_path / "none" / "set.h5")
    assert refusal.value.code == "cannot-write"


def test_arrays_cannot_be_written_to_and_are_not_the_callers() -> None:
    mine = np.full(32, 30.0)
    coefficients = example_set(dark_offset_dn=mine)
    mine[:] = 0.0
    assert (coefficients.dark_offset_dn == 30.0).all()
    with pytest.raises(ValueError, match="read-only"):
        coefficients.dark_offset_dn[0] = 1.0


def test_an_array_of_another_length_is_refused() -> None:
    with pytest.raises(InputError, match="vignette has shape"):
        example_set(vignette=np.ones(31))


def test_the_dark_level_grows_with_the_exposure_by_the_dark_current() -> None:
    coefficients = example_set(dark_current_dn_per_us=np.full(32, 0.01))
    np.testing.assert_allclose(coefficients.dark_level_dn(200.0), 32.0)


def test_the_budget_adds_in_squares_and_tells_common_from_column() -> None:
    budget = example_set().budget
    (row,) = budget.rows
    assert budget.combined == pytest.approx(0.0099)
    assert budget.expanded == pytest.approx(0.0198)
    both = type(budget)("x", "1", (row, type(row)("n", "A", "normal", 3.0, "DN", -0.01, "column")))
    assert both.combined == pytest.approx((0.0099**2 + 0.03**2) ** 0.5)
    assert both.combined_common == pytest.approx(0.0099)


def test_the_summary_names_what_is_masked() -> None:
    summary = example_set().summary()
    assert summary["valid_columns"] == 31
    assert summary["masked"] == {"dead": 1}
    assert summary["edge_fall_percent"] == pytest.approx(50.0)
