"""One self-contained HTML page: a sentence first, then where, how sure, and what it does."""

from collections.abc import Iterable
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from calib.diagnosis.answer.diagnosis import Diagnosis
from calib.diagnosis.diagnose import Examination
from calib.diagnosis.report.compared import Compared
from calib.diagnosis.report.finding import finding_text
from calib.diagnosis.report.groups import groups_of, groups_of_sums
from calib.diagnosis.report.mathematics import mathematics
from calib.diagnosis.report.panel import NARROW, Group, Panel
from calib.diagnosis.report.radiance import CAPTION, radiance_panel
from calib.diagnosis.report.remainder import remainder_panels, remainder_words, term_panel
from calib.diagnosis.shapes.of_effects import departures
from calib.diagnosis.words.verdict import spoken
from calib.errors import NotDeterminedError
from calib.recording.durable import write_whole
from calib.recording.header import CameraHeader
from calib.report.camera_words import camera_line, camera_name
from calib.report.page_style import page_style
from calib.report.rounded import quantity

Content = dict[str, Any]

VERDICTS = {
    "consistent": "consistent",
    "explained": "explained",
    "ambiguous": "ambiguous",
    "unexplained": "unexplained",
    "undiagnosed": "cannot be diagnosed",
}
NO_TERM = (
    "No smooth term against signal, time, exposure, level or temperature describes it: the amended "
    "model carries none."
)


def page(
    diagnosis: Diagnosis, title: str, camera: CameraHeader, examined: Examination | None = None
) -> str:
    """Return the page of a diagnosis; without an examination, as of sums, with what it tells."""
    seen = None if examined is None else Compared(replace(examined, diagnosis=diagnosis))
    shown, folded = groups_of_sums(diagnosis.figures) if seen is None else groups_of(seen)
    content: Content = {
        "camera": f"{camera_name(camera)} · {camera_line(camera)}",
        "verdict": diagnosis.verdict,
        "summary": diagnosis.summary,
        "findings": [finding_text(f) for f in diagnosis.findings],
        "places": [f.where.text for f in diagnosis.findings],
        "groups": [_drawn(group) for group in shown],
        "folded": [_drawn(group) for group in folded],
        "rest": _rest(diagnosis, seen),
        "remarks": diagnosis.remarks,
        "radiance": _radiance(diagnosis),
        **_fits(diagnosis),
        "off": [
            (p.name, f"{p.model:.6g}", quantity(p.fitted, p.std, p.unit))
            for p in diagnosis.model_parameters
        ],
        **_next(diagnosis),
        "not_testable": [(spoken(n), why) for n, why in diagnosis.not_testable.items()],
        "n_effects": len(departures()),
        "mathematics": mathematics([f.effect for f in diagnosis.findings]),
    }
    return _rendered(title, content)


def save_page(
    diagnosis: Diagnosis,
    path: Path,
    title: str,
    camera: CameraHeader,
    examined: Examination | None = None,
) -> None:
    """Write the page to `path`, whole or not at all."""
    write_whole(path, page(diagnosis, title, camera, examined).encode())


def _rendered(title: str, content: Content) -> str:
    text = files("calib.diagnosis.report").joinpath("page.html.j2").read_text("utf-8")
    template = Environment(autoescape=True, undefined=StrictUndefined).from_string(text)
    word = VERDICTS[content["verdict"]]
    return template.render(title=title, style=page_style(), verdict_word=word, **content)


def _drawn(group: Group) -> Content:
    return {"title": group.title, "caption": group.caption, "panels": _pictures(group.panels)}


def _pictures(panels: Iterable[Panel]) -> list[tuple[bool, Markup]]:
    """Return whether each is broad, and its SVG: our own drawing, which may stand unescaped."""
    return [(p.size[0] > NARROW[0], Markup(p.svg())) for p in panels]  # noqa: S704


def _rest(diagnosis: Diagnosis, seen: Compared | None) -> Content | None:
    rest = diagnosis.unexplained
    if rest is None:
        return None
    text = f"{rest.where.text} It is {rest.significance_sigma:.0f} σ from chance, without a name."
    panels: tuple[Panel, ...] = () if seen is None else remainder_panels(seen)
    words = () if seen is None else remainder_words(seen)
    if rest.term is not None:
        words = (*words, rest.term.text)
        panels = (*panels, term_panel(rest.term))
    elif seen is not None:
        words = (*words, NO_TERM)
    return {"text": text, "words": words, "panels": _pictures(panels)}


def _radiance(diagnosis: Diagnosis) -> Content | None:
    found = diagnosis.radiance
    if found is None:
        return None
    pictures = _pictures([radiance_panel(found)] if found.touched else [])
    return {"text": found.text, "pictures": pictures, "caption": CAPTION}


def _fits(diagnosis: Diagnosis) -> Content:
    both = (("plain model", diagnosis.baseline), ("with what was found", diagnosis.final))
    rows = [(name, f"{f.heldout_deviance:.0f}", f.dof) for name, f in both]
    gain = diagnosis.baseline.heldout_deviance - diagnosis.final.heldout_deviance
    words = (
        f"Lower by {gain:.0f}: what was found predicts what the fit did not see."
        if gain > 0
        else "Nothing was found that would predict what the fit did not see any better."
    )
    return {"fits": rows if diagnosis.findings else rows[:1], "fits_words": words}


def _next(diagnosis: Diagnosis) -> Content:
    told = diagnosis.answer()["next_measurement"]
    no_next = {
        "consistent": "there is nothing to decide between.",
        "explained": "every finding has one name.",
    }.get(diagnosis.verdict, "no plan was found that would tell more.")
    if told is None:
        return {"next": None, "no_next": no_next}
    why = str(told["why"]).replace("_", " ")
    if told["expected_sigma"] is not None:
        why += (
            f"; they then differ by {told['expected_sigma']:.1f} σ instead of "
            f"{told['recorded_sigma']:.1f} σ, in {told['seconds']:.0f} s"
        )
    return {"next": {"why": f"A plan that {why}.", "plan": told["plan_toml"]}, "no_next": no_next}


def save_page_of_undiagnosed(error: NotDeterminedError, path: Path, title: str) -> None:
    """Write the page of a recording that cannot be diagnosed: why, and what to add."""
    write_whole(path, page_of_undiagnosed(error, title).encode())


def page_of_undiagnosed(error: NotDeterminedError, title: str) -> str:
    """Return that page."""
    text = str(error)
    content: Content = {
        "camera": "",
        "verdict": "undiagnosed",
        "summary": f"This recording cannot be diagnosed: {text}{'' if text.endswith('.') else '.'}",
        "remarks": (),
        "findings": [], "places": [], "groups": [], "folded": [], "rest": None, "radiance": None,
        "fits": [], "fits_words": "", "off": [], "next": None,
        "no_next": "record the blocks that are named above, and diagnose again.",
        "not_testable": [], "n_effects": len(departures()), "mathematics": mathematics([]),
    }  # fmt: skip
    return _rendered(title, content)
