"""Puts the figures on one page that needs nothing but itself."""

from importlib.resources import files
from pathlib import Path

import numpy as np
from jinja2 import Environment, StrictUndefined, Template
from markupsafe import Markup
from matplotlib.figure import Figure

from calib.mtf.answer import answer
from calib.mtf.report import bench_figure, cut_figure, maps
from calib.mtf.result import TransferResult
from calib.recording.durable import write_whole
from calib.report import style
from calib.transfer.estimate import Estimate

CAPTIONS = {
    "transfer": "Signs are kept: the line is where the real part is 0. Dotted: Nyquist's square.",
    "cuts": "Below, three times √E|δT|². The noise of the images is in it, and what lies between"
    " harmonics.",
    "psf": "Dotted: one pitch. Frequencies beyond the pattern's highest are not measured.",
    "noise": "Where harmonics are sparse, the support decides, and uncertainty grows.",
    "bench": "Errors about the mean of all that are not far astray; each is corrected.",
}


def figures(result: TransferResult) -> dict[str, Figure]:
    """Draw every figure of the report by name, in its order; within the house's style."""
    return {
        "transfer": maps.transfer_map(result),
        "cuts": cut_figure.cut_figure(result),
        "psf": maps.psf_map(result),
        "noise": maps.noise_map(result),
        "bench": bench_figure.bench_figure(result),
    }


def write_report(path: Path, result: TransferResult) -> None:
    """Write the report to `path`, whole or not at all."""
    with style.house_style():
        # Our own drawing, not text from outside: it may stand unescaped.
        pictures = [
            (Markup(style.as_svg(figure)), CAPTIONS[name])  # noqa: S704
            for name, figure in figures(result).items()
        ]
    text = _template().render(
        title="Pixel transfer function",
        method=_method(result),
        facts=_facts(result),
        warnings=answer(result)["warnings"],
        pictures=pictures,
        id=result.id,
    )
    write_whole(path, text.encode("utf-8"))


def _method(result: TransferResult) -> str:
    found = result.measurement
    by = {
        "regularised": "least squares on all harmonics, a PSF on a compact support",
        "filter": "multi-frame linear regressive filter (Eq. 6)",
    }[found.method]
    return (
        f"{by} · pitch {found.scan.pitch_um:g} µm · {found.grating.n_orders} orders,"
        f" {found.grating.harmonics.count} harmonics ·"
        f" {len(found.fit.state.sampling.frames)} stage positions"
    )


def _facts(result: TransferResult) -> tuple[tuple[str, str], ...]:
    found, told = result.measurement, answer(result)
    x, y = result.first_zeros
    shift = zip(told["grating_shift_um"], told["grating_shift_std_um"], strict=True)
    return (
        ("First zero along x", _told(x)),
        ("First zero along y", _told(y)),
        ("MTF at Nyquist along x", _told(result.nyquist["x"])),
        ("MTF at Nyquist along y", _told(result.nyquist["y"])),
        ("Mean standard uncertainty in the disc", f"{result.mean_std:.2g}"),
        ("The pattern lies at", ", ".join(f"{v:.4f} ± {s:.1g} µm" for v, s in shift)),
        ("Tilt beyond atan(m/n)", f"{np.degrees(found.fit.tilt_rad[0]):+.5f}°"),
        ("Scale error", f"{100 * found.fit.scale[0]:+.5f} %"),
        ("Gain scatter of the pixels", f"{told['gain_scatter_percent']:.2g} %"),
        ("Noise, relative to the mean light", f"{100 * told['noise_relative']:.2g} %"),
    )


def _told(each: Estimate) -> str:
    unit = "" if each.unit == "1" else f" {each.unit}"
    return f"{each.value:.5g} ± {each.std:.1g}{unit}" if each.is_known else each.reason


def _template() -> Template:
    text = files("calib.mtf.report").joinpath("page.html.j2").read_text("utf-8")
    return Environment(autoescape=True, undefined=StrictUndefined).from_string(text)
