"""Puts the figures on one page that needs nothing but itself."""

from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import files
from itertools import islice
from pathlib import Path

from jinja2 import Environment, StrictUndefined, Template
from markupsafe import Markup
from matplotlib.figure import Figure

from calib.radiometric.calibration import Calibration
from calib.radiometric.correction.apply import Correction
from calib.radiometric.report import (
    columns,
    correction,
    noise,
    order,
    residuals,
    response,
    words,
)
from calib.radiometric.uniformity import nearest_to_half_scale
from calib.recording.block_statistics import RecordingStatistics
from calib.recording.durable import write_whole
from calib.recording.protocol import Recording
from calib.report import camera_words, style
from calib.report.page_style import page_style

CAPTIONS = {
    "before-and-after": "Masked columns are left blank, never filled in.",
    "dark-offset": "The band is twice the standard uncertainty, which stands below.",
    "slope": "The polynomial is what optics do to all columns; the scatter about it is QE's.",
    "responsivity": "Its uncertainty includes the radiance scale's, which all columns share.",
    "order": "The order is the one that predicts columns which the fit did not see.",
    "linearity": "A residual that bends is a nonlinear response; one that wanders, the source. The "
    "bars contain what the dark offsets of all columns have in common.",
    "photon-transfer": "Shot noise makes a straight line; its slope is the system gain.",
    "radiance-scale": "The certificate's levels against each other, as the camera sees them.",
    "residuals": "Noise looks like noise. Stripes, slopes or single rows are physics left out. "
    "Two darks or more stand against their own mean, not against the intercepts.",
}


@dataclass(frozen=True)
class ReportFigure:
    """A figure, the heading it stands under, and its name (a file's, in the gallery)."""

    section: str
    name: str
    figure: Figure


@dataclass(frozen=True)
class Picture:
    """An inline SVG and what to see in it."""

    svg: Markup
    caption: str


@dataclass(frozen=True)
class Section:
    """Pictures under one heading."""

    title: str
    pictures: tuple[Picture, ...]


def write_report(
    path: Path,
    recording: Recording,
    calibration: Calibration,
    statistics: RecordingStatistics,
    remarks: tuple[str, ...] = (),
) -> None:
    """Write the calibration's report to `path`, whole or not at all; `remarks` follow its lead."""
    with style.house_style():
        sections = tuple(_sections(recording, calibration, statistics))
    text = _template().render(
        title=f"Calibration of {camera_words.camera_name(recording.header.camera)}",
        camera=camera_words.camera_line(recording.header.camera),
        source=words.source_line(recording.header),
        style=page_style(),
        lead=(*words.lead(calibration), *remarks),
        warnings=calibration.warnings,
        facts=words.facts(calibration),
        sections=sections,
        budget=calibration.coefficients.budget,
        provenance=words.provenance(calibration.coefficients),
    )
    write_whole(path, text.encode())


def figures(
    recording: Recording, calibration: Calibration, statistics: RecordingStatistics
) -> tuple[ReportFigure, ...]:
    """Draw every figure of the report, in its order."""
    found, blocks = calibration.coefficients, statistics.fit
    effect, coefficients, belief = (
        "What the correction does",
        "The coefficients",
        "Can the model be believed?",
    )
    drawn = (
        (effect, "before-and-after", _before_and_after(recording, calibration, statistics)),
        (coefficients, "dark-offset", columns.dark_offset(calibration)),
        (coefficients, "slope", columns.slope(calibration)),
        (coefficients, "responsivity", columns.responsivity(calibration)),
        (coefficients, "order", order.order_choice(calibration.figures.order_choice)),
        (belief, "linearity", response.linearity(calibration, blocks)),
        (belief, "photon-transfer", noise.photon_transfer(found, blocks)),
        (belief, "radiance-scale", response.radiance_scale(calibration)),
        (belief, "residuals", residuals.residual_map(found, blocks)),
    )
    return tuple(ReportFigure(s, name, figure) for s, name, figure in drawn if figure is not None)


def _sections(
    recording: Recording, calibration: Calibration, statistics: RecordingStatistics
) -> Iterator[Section]:
    titles: dict[str, list[Picture]] = {}
    for drawn in figures(recording, calibration, statistics):
        # Our own drawing, not text from outside: it may stand unescaped.
        svg = Markup(style.as_svg(drawn.figure))  # noqa: S704
        titles.setdefault(drawn.section, []).append(Picture(svg, CAPTIONS[drawn.name]))
    for title, pictures in titles.items():
        yield Section(title, tuple(pictures))


def _before_and_after(
    recording: Recording, calibration: Calibration, statistics: RecordingStatistics
) -> Figure | None:
    camera = recording.header.camera
    shown = nearest_to_half_scale(statistics.fit, camera.full_scale_dn)
    if shown is None:
        return None
    raw = next(islice(recording.frames(shown.block.block), 1), None)
    if raw is None or camera.rows is not None:
        return None
    made = Correction(calibration.coefficients, shown.block.exposure_us, camera=camera)
    return correction.before_and_after(raw, made, shown.block.block)


def _template() -> Template:
    text = files("calib.radiometric.report").joinpath("page.html.j2").read_text("utf-8")
    return Environment(autoescape=True, undefined=StrictUndefined).from_string(text)
