"""A run: recordings that open, answers that are sealed, lines that survive its end."""

import json
from pathlib import Path

import pytest

from calib.recording.open import open_recording
from tests.concealed.generator.answer import take_case
from tests.concealed.generator.case import Case, Hidden
from tests.concealed.generator.catalogue import ALL
from tests.concealed.generator.folder import write_folder
from tests.concealed.generator.suite import PART, suite
from tests.concealed.scoring.figures import draw_all
from tests.concealed.scoring.outcome import outcomes
from tests.concealed.scoring.run import finished, run
from tests.concealed.scoring.visibility import visible_in

CONSISTENT = "tests.concealed.scripted:consistent"
CASES = (
    Case(0, "clean", (), 1, 20_000),
    Case(1, "single", (Hidden("line_noise", "gaussian", 1.0),), 2, 20_000),
    Case(2, "double", (Hidden("lag", "each_electron", 0.8), Hidden("cti", "constant", 1.0)), 3,
         20_000),
)  # fmt: skip


@pytest.mark.parametrize("seed", range(8))
def test_a_folder_opens_without_a_warning_and_names_nothing_that_is_hidden(
    seed: int, tmp_path: Path
) -> None:
    case = Case(0, "clean", (), seed, 30_000)
    taken, _ = take_case(case)
    setting = case.setting
    write_folder(tmp_path / "rec", setting.sensor, setting.plan, taken, case.rng("instruments"))
    recording = open_recording(tmp_path / "rec")
    assert recording.warnings == ()
    header = recording.header
    assert header.camera.bit_depth == setting.sensor.bit_depth
    assert header.camera.rows == (setting.sensor.rows if setting.sensor.area else None)
    assert [b.exposure_us for b in header.blocks] == [b.exposure_us for b in setting.plan.blocks]
    for block, drawn in zip(header.blocks, taken, strict=True):
        (codes,) = recording.frames(block.block)
        assert codes.tobytes() == drawn.codes.tobytes()
    text = "".join(p.read_text() for p in (tmp_path / "rec").iterdir() if p.is_file())
    assert not any(name in text for name in ALL)


def test_a_run_that_is_cut_off_goes_on_and_its_answers_open(tmp_path: Path) -> None:
    run(CASES, CONSISTENT, tmp_path)
    lines = (tmp_path / "diagnoses.jsonl").read_text().splitlines()
    (tmp_path / "diagnoses.jsonl").write_text("\n".join([lines[0], lines[1][:20]]))
    assert len(finished(tmp_path)) == 1
    run(CASES, CONSISTENT, tmp_path)
    every = list(outcomes(tmp_path, visible_in(CASES, tmp_path)))
    assert [one.number for one in every] == [0, 1, 2]
    assert [len(one.truths) for one in every] == [0, 1, 2]
    assert every[1].truths[0].sigma > 7
    assert {one.verdict for one in every} == {"consistent"}


def test_another_run_s_folder_is_refused(tmp_path: Path) -> None:
    run(CASES[:1], CONSISTENT, tmp_path)
    with pytest.raises(ValueError, match="another run"):
        run(CASES[:2], CONSISTENT, tmp_path)


def test_an_answer_that_was_changed_after_the_diagnosis_is_found_out(tmp_path: Path) -> None:
    run(CASES[:1], CONSISTENT, tmp_path)
    sealed = tmp_path / "answers" / "00000.sealed"
    other = tmp_path / "other"
    run((Case(0, "clean", (), 99, 20_000),), CONSISTENT, other)
    sealed.write_bytes((other / "answers" / "00000.sealed").read_bytes())
    with pytest.raises(ValueError, match="committed"):
        list(outcomes(tmp_path, {}))
    (tmp_path / "diagnoses.jsonl").write_text((other / "diagnoses.jsonl").read_text())
    with pytest.raises(ValueError, match="committed"):
        list(outcomes(tmp_path, {}))


def test_a_diagnosis_that_fails_is_an_outcome(tmp_path: Path) -> None:
    run(CASES[:1], "tests.concealed.scripted:failing", tmp_path)
    (only,) = outcomes(tmp_path, {})
    assert only.verdict == "error"
    assert only.error == "RuntimeError: no diagnosis of 12 letters"


def test_what_is_written_before_the_end_tells_nothing(tmp_path: Path) -> None:
    run(CASES[1:2], CONSISTENT, tmp_path)
    for name in ("run.json", "commitments.jsonl", "diagnoses.jsonl"):
        assert "line_noise" not in (tmp_path / name).read_text()
    line = json.loads((tmp_path / "commitments.jsonl").read_text())
    assert set(line) == {"number", "sha256"}


@pytest.mark.soak
def test_the_part_of_the_suite_that_ci_runs_goes_through(tmp_path: Path) -> None:
    cases = suite("soak", PART)
    run(cases, CONSISTENT, tmp_path, workers=2)
    every = list(outcomes(tmp_path, visible_in(cases, tmp_path, workers=2)))
    assert len(every) == len(cases)
    draw_all(every, tmp_path / "figures")
    assert len(list((tmp_path / "figures").glob("*.png"))) == 6
