"""A set may carry a transfer function; one that does not keeps the id that it always had."""

from pathlib import Path

from calib.radiometric.coefficients.coefficient_metadata import to_metadata
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.coefficients.transfer_reference import TransferReference
from tests.calib.radiometric.example_set import example_set

REFERENCE = TransferReference(
    "f" * 64, "regularised", 25.0, (40.1, None), (0.63, 0.62), (1e-4, 2e-4)
)


def test_a_set_without_one_says_nothing_of_it() -> None:
    assert "transfer_function" not in to_metadata(example_set(8))


def test_a_set_with_one_has_another_id_and_comes_back_whole(tmp_path: Path) -> None:
    before = example_set(8)
    made = before.with_transfer_function(REFERENCE)
    assert made.id != before.id
    made.save(tmp_path / "set.h5")
    back = CoefficientSet.load(tmp_path / "set.h5")
    assert back.id == made.id
    assert back.transfer_function == REFERENCE
    assert back.with_transfer_function(REFERENCE).id == made.id
