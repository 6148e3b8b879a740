"""What a person sees of a diagnosis: parsed, and held against the answer and the physics."""

import json
import re
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from numpy.random import default_rng

from calib.diagnosis.answer.diagnosis import Unexplained
from calib.diagnosis.answer.finding import NamedCandidate, Where
from calib.diagnosis.answer.radiance_check import radiance_error
from calib.diagnosis.baseline.requirements import check_can_be_diagnosed
from calib.diagnosis.diagnose import Examination
from calib.diagnosis.given.known import beside
from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.search import find
from calib.diagnosis.report.compared import Compared
from calib.diagnosis.report.groups import groups_of
from calib.diagnosis.report.page import page, page_of_undiagnosed
from calib.diagnosis.report.panel import Group
from calib.diagnosis.shapes.of_effects import shapes_of
from calib.diagnosis.signatures.looked_for import scales_of
from calib.diagnosis.signatures.signature import signature
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.diagnosis.words.verdict import first_sentence
from calib.errors import NotDeterminedError
from calib.forward.drift import settled
from calib.forward.effects.interpixel_capacitance import InterpixelCapacitance
from calib.forward.effects.lamp_drift import LampDrift
from calib.forward.effects.nonlinearity import Nonlinearity
from calib.recording.header import CameraHeader, RecordingHeader
from tests.calib.diagnosis.examinations import examined, small_model
from tests.calib.diagnosis.recordings import plan, recorded

COUPLING = 0.04
BENT = 5e-6
"""Per DN: 1.5 % at full scale; looked for alone, whatever other names there are."""


class Page(HTMLParser):
    """Text, headings, tags, and all that a browser would fetch."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.words: list[str] = []
        self.headings: list[str] = []
        self.fetched: list[str] = []
        self.tags: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        for name, value in attrs:
            local = (value or "").startswith(("#", "data:"))
            if name in {"src", "href", "xlink:href", "action", "poster"} and not local:
                self.fetched.append(str(value))

    def handle_data(self, data: str) -> None:
        self.words.append(data)
        if self.tags and self.tags[-1] in {"h2", "h3"}:
            self.headings.append(data.strip())

    @property
    def text(self) -> str:
        """All of it, white space made one."""
        return " ".join(" ".join(self.words).split())


@cache
def capacitance() -> Examination:
    return examined((InterpixelCapacitance(COUPLING),))


@cache
def drawn(verdict: str) -> str:
    """Return the page of each verdict, of one recording whose finding is made unsure or lost."""
    found = examined() if verdict == "consistent" else capacitance()
    diagnosis = found.diagnosis
    if verdict == "consistent":
        diagnosis = replace(diagnosis, findings=(), unexplained=None)
        model = replace(
            found.model, members=(), change=None, residual=found.model.first,
            baseline=found.evidence.baseline,
        )  # fmt: skip
        found = replace(found, model=model)
    if verdict == "explained":
        one = replace(diagnosis.findings[0], candidates=diagnosis.findings[0].candidates[:1])
        diagnosis = replace(diagnosis, findings=(one,), unexplained=None)
    if verdict == "ambiguous":
        names = (
            NamedCandidate("interpixel_capacitance", 0.7, 1.0), NamedCandidate("cti", 0.3, 2.0)
        )  # fmt: skip
        one = replace(diagnosis.findings[0], candidates=names)
        diagnosis = replace(diagnosis, findings=(one,), unexplained=None)
    if verdict == "unexplained":
        where = Where("mean", ("time",), (0, 95), ("003",), "Seen in the means of blocks.")
        diagnosis = replace(diagnosis, unexplained=Unexplained(31.4, where))
    assert diagnosis.verdict == verdict
    diagnosis = replace(diagnosis, summary=first_sentence(diagnosis))
    with pytest.MonkeyPatch.context() as patch:
        if verdict != "unexplained":  # whose page draws all there is
            patch.setattr("calib.diagnosis.report.page.groups_of", first_group)
        return page(diagnosis, f"A {verdict} recording", found.evidence.sensor.camera, found)


def first_group(seen: Compared) -> tuple[tuple[Group, ...], tuple[Group, ...]]:
    """Return the group that shows the most, and no other: drawing all takes seconds."""
    return groups_of(seen)[0][:1], ()


FIRST = {
    "consistent": "shows nothing beyond the plain model",
    "explained": "One departure from the plain model was found and named",
    "ambiguous": "cannot tell what it is: interpixel capacitance or charge transfer inefficiency.",
    "unexplained": "something remains, 31 standard deviations from chance",
}


@pytest.mark.parametrize("verdict", list(FIRST))
def test_each_verdict_has_a_first_sentence_and_a_page_of_its_own(verdict: str) -> None:
    shown = Page(drawn(verdict))
    assert FIRST[verdict] in shown.text
    others = [sentence for name, sentence in FIRST.items() if name != verdict]
    assert not any(sentence in shown.text for sentence in others)
    assert ("How sure" in shown.headings) == (verdict != "consistent")
    assert ("What remains" in shown.headings) == (verdict == "unexplained")
    assert "What to measure next" in shown.headings
    assert "The mathematics" in shown.headings
    assert shown.tags.count("svg") >= (20 if verdict == "unexplained" else 3)


@pytest.mark.parametrize("verdict", list(FIRST))
def test_no_request_leaves_the_machine(verdict: str) -> None:
    text = drawn(verdict)
    shown = Page(text)
    assert shown.fetched == []
    assert not {"script", "link", "iframe", "object", "embed", "img"} & set(shown.tags)
    assert "@import" not in text
    assert set(re.findall(r"url\((.)", text)) <= {"#"}


def test_what_cannot_be_diagnosed_says_which_blocks_to_add() -> None:
    with pytest.raises(NotDeterminedError) as caught:
        check_can_be_diagnosed(RecordingHeader(camera=CameraHeader(columns=8, bit_depth=12)))
    shown = Page(page_of_undiagnosed(caught.value, "A recording of nothing"))
    assert "cannot be diagnosed: the recording has no flats: add flats" in shown.text
    assert "cannot be diagnosed" in shown.words


def test_the_sentence_has_the_answers_number() -> None:
    diagnosis = capacitance().diagnosis
    finding = next(f for f in diagnosis.answer()["findings"] if "column" in f["sentence"])
    stated = re.search(r"share ([\d.]+) %", finding["sentence"])
    assert stated is not None
    value = finding["parameters"]["column_coupling"]
    # One digit of the uncertainty, and no more than a hundredth of the value.
    digit = 10.0 ** np.floor(np.log10(max(value["std"], 0.01 * value["value"])))
    assert abs(float(stated[1]) / 100.0 - value["value"]) <= 0.5 * digit * (1 + 1e-9)
    assert stated[0] in Page(drawn("explained")).text


def test_capacitance_hid_as_the_system_gain_that_its_formula_gives() -> None:
    finding = capacitance().diagnosis.findings[0]
    hidden = next(a for a in finding.absorbed if a.name == "system gain")
    # A line's shot noise keeps (1 - 2 c)^2 + 2 c^2 of its variance.
    kept = (1.0 - 2.0 * COUPLING) ** 2 + 2.0 * COUPLING**2
    coupling = finding.parameters["column_coupling"]
    # The fit's own part: what 1 - kept moves with c, and signatures that scatter by 2 %.
    unsure = 4.0 * np.hypot(coupling.std, 0.02 * COUPLING)
    assert abs(hidden.difference - (kept - 1.0)) < 5.0 * np.hypot(hidden.std, unsure)
    assert f"a system gain {100 * abs(hidden.difference):.0f}"[:16] in finding.hid_as
    assert "too low" in finding.hid_as


@pytest.mark.parametrize(
    ("effect", "of_camera"),
    [(Nonlinearity(BENT), True), (LampDrift(-0.03, 5.0), False)],
    ids=["nonlinearity", "lamp_drift"],
)
def test_the_radiance_by_the_plain_calibration_is_off_as_a_line_fitted_to_the_effect_is(
    effect: Nonlinearity | LampDrift, *, of_camera: bool
) -> None:
    rng = default_rng()
    evidence = recorded(small_model(), plan(rng, 120, twice=2), rng, (effect,))
    responder = responder_of(evidence)
    shapes = shapes_of(type(effect), scales_of(evidence, responder))
    signatures = [signature(shape, evidence, responder) for shape in shapes]
    contest = Contest(tuple(s for s in signatures if s is not None), evidence, responder)
    error = radiance_error(find(contest, beside(None, evidence)), evidence)
    assert error is not None
    base, table, truth = evidence.baseline, evidence.table, small_model().truth()
    weight = evidence.n / base.variance_dn2.mean(axis=(1, 2))
    dose = table.dose
    signal = dose[:, None] * (truth.responsivity * truth.vignette)[None, :]
    seen = signal * (1.0 - BENT * signal)
    if isinstance(effect, LampDrift):
        seen = (
            signal
            * (1.0 + effect.amplitude * settled(table.mid_s, effect.time_constant_s))[:, None]
        )
    line = np.polynomial.polynomial.polyfit(dose, seen, 1, w=np.sqrt(weight))
    # A scene is not lit by the lamp that faded: it is seen as it is.
    scene = seen if of_camera else signal
    lit = dose > 0
    plain = (scene - line[0])[lit] / (line[1] * dose[lit, None]) - 1.0
    names = [n for n, on in zip(table.names, lit, strict=True) if on]
    expected = {n: float(np.median(e)) for n, e in zip(names, plain, strict=True)}
    largest = max(abs(e) for e in expected.values())
    assert largest > 3e-3
    for name, value, left in zip(error.blocks, error.error, error.left_std, strict=True):
        # What a fit of this recording leaves of DN0 and slope, and of the strength and its time.
        noise = 0.2 / base.mean_dn[table.names.index(name)].mean()
        assert abs(value - expected[name]) < 5.0 * np.hypot(left, noise) + 0.1 * largest


def test_figures_of_the_answer_are_plain_numbers(tmp_path: Path) -> None:
    answer = capacitance().diagnosis.answer()
    (tmp_path / "answer").write_text(json.dumps(answer, allow_nan=False))
    assert answer["summary"]
    assert answer["radiance_error"]["text"]
