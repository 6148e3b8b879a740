"""Diagnosis of `statistics.csv`: what is named in sums that were drawn, and how well."""

from pathlib import Path

import numpy as np
import pytest

from calib.diagnosis.shapes.of_effects import departures
from calib.diagnosis.sums.amended import amended_model
from calib.diagnosis.sums.diagnose import SumsExamination, diagnose_sums
from calib.errors import NotDeterminedError
from calib.forward.model import Model
from calib.recording.folder_recording import FolderRecording
from calib.transfer.photon_transfer.variance_curve import Shape

GAIN, READ_DN2, DARK_DN, RATE = 0.29, 9.4, 40.0, 1.1
EXPOSURES_US = np.linspace(100.0, 3200.0, 24)
PIXELS = 300_000
BENT, REPELLED = 4e-6, -4e-6
"""Per DN: 1.4 % at the top; per electron: 5 % of the variance there."""
CONDITIONS = "block,kind,exposure_us,level,started_s,sensor_temperature_c,lines,radiance"


def sums(
    folder: Path, seed: int, *, beta: float = 0.0, a00: float = 0.0, unrest: float = 5e-4,
    scatter: float = 0.0,
) -> FolderRecording:  # fmt: skip
    """Write means and variances as two frames of each exposure would have them."""
    rng = np.random.default_rng(seed)
    folder.mkdir()
    camera = "[camera]\ncolumns = 640\nrows = 480\nbit_depth = 12\n"
    (folder / "recording.toml").write_text(camera)
    shape = Shape(GAIN, READ_DN2, beta, a00)
    rows, kept = [CONDITIONS], ["block,samples,mean_dn,variance_dn2"]
    for k, exposure in enumerate(EXPOSURES_US):
        for kind in ("flat", "dark"):
            light = RATE * exposure * (kind == "flat") * (1.0 + unrest * rng.standard_normal())
            mean = float(shape.mean(np.array(light), np.array(0.0)))
            variance = float(shape.variance(np.array([mean]))[0])
            mean += DARK_DN + np.sqrt(variance / (2 * PIXELS)) * rng.standard_normal()
            variance *= 1.0 + scatter * rng.standard_normal()
            variance *= rng.chisquare(PIXELS) / PIXELS
            rows.append(f"{kind}{k:02d},{kind},{exposure},{int(kind == 'flat')},,,2,")
            kept.append(f"{kind}{k:02d},{2 * PIXELS},{mean},{variance}")
    (folder / "conditions.csv").write_text("\n".join(rows) + "\n")
    (folder / "statistics.csv").write_text("\n".join(kept) + "\n")
    return FolderRecording(folder)


def test_plain_sums_are_called_consistent(tmp_path: Path) -> None:
    verdicts = [
        diagnose_sums(sums(tmp_path / str(seed), seed)).diagnosis.verdict for seed in range(5)
    ]
    # Two looks at three standard errors: one in two hundred has a finding.
    assert verdicts.count("consistent") >= 4


@pytest.fixture(scope="module")
def bent(tmp_path_factory: pytest.TempPathFactory) -> list[SumsExamination]:
    folder = tmp_path_factory.mktemp("bent")
    return [diagnose_sums(sums(folder / str(s), s, beta=BENT)) for s in range(7)]


def test_a_bent_response_is_named_alone_and_as_strong_as_it_is(
    bent: list[SumsExamination],
) -> None:
    z = []
    for each in bent:
        (finding,) = each.diagnosis.findings
        assert finding.effect.name == "nonlinearity"
        beta = finding.parameters["beta_per_dn"]
        z.append((beta.value - BENT) / beta.std)
    # Four standard errors of a mean and of a variance of n normal numbers.
    n = len(z)
    assert abs(np.mean(z)) < 4.0 / np.sqrt(n)
    assert abs(np.var(z, ddof=1) - 1.0) < 4.0 * np.sqrt(2.0 / (n - 1))


def test_a_bend_that_is_known_predicts_what_was_left_out(bent: list[SumsExamination]) -> None:
    for each in bent:
        (finding,) = each.diagnosis.findings
        # The plain model spends what it misses on a source that it calls unsteady: the gain is
        # what the larger scatter costs, ln(eta ratio) for each mean, many times chance's few.
        assert finding.heldout_before - finding.heldout_after > 50.0
        # Deviance and its expectation for the right curve scatter by sqrt(2 dof), here 12.
        assert finding.fraction_explained > 0.5
        remark = next(r for r in each.diagnosis.remarks if r.startswith("brighter_fatter"))
        assert "not called for" in remark


def test_an_operator_is_told_how_much_is_lost_at_the_top(bent: list[SumsExamination]) -> None:
    top = RATE * EXPOSURES_US[-1]
    for each in bent:
        (finding,) = each.diagnosis.findings
        lost = float(finding.sentence.split("gives ")[1].split(" %")[0])
        std = finding.parameters["beta_per_dn"].std
        # Printed to a hundredth; the noise's own part of the bend is beta times its variance.
        assert abs(lost - 100.0 * BENT * top) < 4.0 * 100.0 * std * top + 0.01


def test_charge_that_repels_is_named_by_the_variances(tmp_path: Path) -> None:
    z = []
    for seed in range(3):
        found = diagnose_sums(sums(tmp_path / str(seed), seed, a00=REPELLED)).diagnosis
        (finding,) = found.findings
        assert finding.effect.name == "brighter_fatter"
        assert finding.where.statistic == "variance"
        of = finding.parameters
        lost = 2.0 * (of["row_per_e"].value + of["column_per_e"].value)
        lost += 4.0 * of["corner_per_e"].value
        std = of["row_per_e"].std / of["row_per_e"].value * lost
        z.append((lost + REPELLED) / std)
    assert abs(np.mean(z)) < 4.0 / np.sqrt(len(z))
    # Chi-squared of three: beyond 21.1 in one of ten thousand.
    assert np.sum(np.square(z)) < 21.1


def test_variances_that_scatter_are_told_and_are_no_brighter_fatter_effect(tmp_path: Path) -> None:
    for seed in range(3):
        found = diagnose_sums(sums(tmp_path / str(seed), seed, beta=BENT, scatter=0.01)).diagnosis
        assert [f.effect.name for f in found.findings] == ["nonlinearity"]
        assert found.verdict == "unexplained"
        assert found.unexplained is not None
        assert found.unexplained.where.statistic == "variance"
        assert "beyond" in found.unexplained.where.text


def test_every_other_effect_is_not_testable_and_why_is_said(bent: list[SumsExamination]) -> None:
    told = bent[0].diagnosis.not_testable
    every = {kind.name for kind in departures()}
    assert set(told) == every - {"nonlinearity", "brighter_fatter"}
    assert all(why.strip() for why in told.values())


def test_the_amended_model_gives_what_was_seen(bent: list[SumsExamination]) -> None:
    model = amended_model(bent[0])
    assert Model.loads(model.dumps()) == model
    truth = model.truth()
    assert truth.system_gain_dn_per_e == pytest.approx(GAIN, rel=0.02)
    assert truth.read_noise_e == pytest.approx(np.sqrt(READ_DN2) / GAIN, rel=0.02)
    light = float(truth.responsivity.mean() * EXPOSURES_US[-1])
    assert light == pytest.approx(RATE * EXPOSURES_US[-1], rel=1e-3)


def test_levels_alone_leave_two_names(tmp_path: Path) -> None:
    recording = sums(tmp_path / "levels", 3, beta=BENT)
    folder = tmp_path / "levels"
    lines = (folder / "conditions.csv").read_text().splitlines()
    rows = [line.split(",") for line in lines[1:]]
    for row in rows:
        row[3] = str(float(row[2]) * float(row[3]))
        row[2] = "1000"
    text = "\n".join([lines[0], *(",".join(row) for row in rows)])
    (folder / "conditions.csv").write_text(text + "\n")
    recording = FolderRecording(folder)
    found = diagnose_sums(recording).diagnosis
    (finding,) = found.findings
    assert {c.effect for c in finding.candidates} == {"nonlinearity", "brighter_fatter"}
    assert found.verdict == "ambiguous"


def test_sums_without_variances_are_refused_in_one_sentence(tmp_path: Path) -> None:
    recording = sums(tmp_path / "bare", 0)
    path = recording.path / "statistics.csv"
    rows = [",".join(line.split(",")[:3]) for line in path.read_text().splitlines()]
    path.write_text("\n".join([rows[0] + ",variance_dn2", *(f"{r}," for r in rows[1:])]) + "\n")
    with pytest.raises(NotDeterminedError, match="variance_dn2"):
        diagnose_sums(FolderRecording(recording.path))
