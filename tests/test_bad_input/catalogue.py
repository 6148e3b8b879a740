"""All cases, in the order of docs/bad-input.md."""

from dataclasses import dataclass

from tests.test_bad_input.case import Case
from tests.test_bad_input.cases import (
    benches,
    calibrations,
    corrections,
    models,
    outputs,
    plans,
    recording_files,
    recording_folders,
    stores,
    transfer_functions,
    transfers,
)


@dataclass(frozen=True)
class Section:
    """A table of the page."""

    title: str
    cases: tuple[Case, ...]


SECTIONS = (
    Section("Recording folders", recording_folders.CASES),
    Section("Recording files", recording_files.CASES),
    Section("What does not determine a calibration", calibrations.CASES),
    Section("Coefficient sets and the lines to correct", corrections.CASES),
    Section("What does not determine photon transfer", transfers.CASES),
    Section("What does not determine a transfer function", transfer_functions.CASES),
    Section("Plans", plans.CASES),
    Section("Models", models.CASES),
    Section("Benches", benches.CASES),
    Section("Outputs", outputs.CASES),
    Section("The store", stores.CASES),
)
CASES = tuple(case for section in SECTIONS for case in section.cases)
