"""One self-contained HTML page: what was found, where, how sure, and what remains."""

from html import escape
from pathlib import Path

import numpy as np

from calib.diagnosis.figures import Figures
from calib.diagnosis.findings import Diagnosis, Finding
from calib.report.style import as_svg, house_style, new_figure

_VERDICTS = {
    "consistent": "The recording shows nothing beyond the plain model and chance.",
    "explained": "Every departure from the plain model has a name, and what remains is chance.",
    "ambiguous": "Something was found that more than one effect would explain as well.",
    "unexplained": "Something remains that no effect of the catalogue makes.",
}
_STYLE = (
    "body{font:16px/1.5 sans-serif;max-width:60em;margin:2em auto;color:#20262e;padding:0 1em}"
    "table{border-collapse:collapse}td,th{padding:.2em 1em .2em 0;text-align:left;"
    "border-bottom:1px solid #e4e8ec}svg{max-width:100%;height:auto}"
)


def page(diagnosis: Diagnosis, title: str) -> str:
    """Return the page of a diagnosis."""
    parts = [
        f"<h1>{escape(title)}</h1>",
        f"<p><strong>{diagnosis.verdict}.</strong> {_VERDICTS[diagnosis.verdict]}</p>",
        *(_finding(each) for each in diagnosis.findings),
        _unexplained(diagnosis),
        "<h2>Before and after</h2>",
        residual_planes(diagnosis.figures),
        _fits(diagnosis),
        _off(diagnosis),
        _not_testable(diagnosis),
    ]
    body = "\n".join(part for part in parts if part)
    return (
        f"<!doctype html><html lang='en'><head><meta charset='utf-8'>"
        f"<title>{escape(title)}</title><style>{_STYLE}</style></head><body>{body}</body></html>"
    )


def save_page(diagnosis: Diagnosis, path: Path, title: str) -> None:
    """Write the page to `path`, whole or not at all."""
    partial = path.with_name(path.name + ".partial")
    partial.write_text(page(diagnosis, title), encoding="utf-8")
    partial.replace(path)


def residual_planes(figures: Figures) -> str:
    """Return the means' residuals by block and column, before and after, as SVG."""
    with house_style():
        figure = new_figure(7.2, 3.2)
        axes = figure.subplots(1, 2, sharey=True)
        for axis, means, title in zip(
            axes,
            (figures.residual_means, figures.final_means),
            ("Plain model", "With what was found"),
            strict=True,
        ):
            step = max(1, means.shape[1] // _MOST_BINS)
            usable = means.shape[1] // step * step
            binned = means[:, :usable].reshape(len(means), -1, step).sum(axis=2) / np.sqrt(step)
            drawn = axis.imshow(
                binned, aspect="auto", cmap="RdBu_r", vmin=-_SPAN, vmax=_SPAN,
                extent=(0, usable, len(means) - 0.5, -0.5), interpolation="nearest",
            )  # fmt: skip
            axis.set(title=title, xlabel="pixel")
            axis.grid(visible=False)
        axes[0].set_ylabel("block, as acquired")
        figure.colorbar(drawn, ax=axes, label="residual / its standard deviation")
        return as_svg(figure)


_MOST_BINS = 64
_SPAN = 5.0


def _finding(finding: Finding) -> str:
    names = ", ".join(f"{c.effect} {100 * c.probability:.0f} %" for c in finding.candidates)
    rows = "".join(
        f"<tr><td>{escape(name)}</td><td>{e.value:.4g} ± {e.std:.2g} {escape(e.unit)}</td></tr>"
        for name, e in finding.parameters.items()
    )
    return (
        f"<h2>{escape(finding.effect.name)}</h2><p>{escape(finding.effect.physics)}</p>"
        f"<p>{escape(finding.where.text)}</p>"
        f"<p>Seen at {finding.significance_sigma:.1f} σ. It may be: {escape(names)}. "
        f"It explains {100 * finding.fraction_explained:.0f} % of what blocks left out missed.</p>"
        f"<table>{rows}</table>"
    )


def _unexplained(diagnosis: Diagnosis) -> str:
    rest = diagnosis.unexplained
    if rest is None:
        return ""
    return (
        f"<h2>Unexplained</h2><p>{escape(rest.where.text)} "
        f"It is {rest.significance_sigma:.1f} σ from chance.</p>"
    )


def _fits(diagnosis: Diagnosis) -> str:
    rows = "".join(
        f"<tr><td>{name}</td><td>{fit.heldout_deviance:.1f}</td><td>{fit.dof}</td></tr>"
        for name, fit in (("plain model", diagnosis.baseline), ("final model", diagnosis.final))
    )
    head = "<tr><th></th><th>deviance of blocks left out</th><th>numbers predicted</th></tr>"
    return f"<table>{head}{rows}</table>"


def _off(diagnosis: Diagnosis) -> str:
    if not diagnosis.model_parameters:
        return ""
    rows = "".join(
        f"<tr><td>{escape(p.name)}</td><td>{p.model:.6g}</td>"
        f"<td>{p.fitted:.6g} ± {p.std:.2g} {escape(p.unit)}</td></tr>"
        for p in diagnosis.model_parameters
    )
    head = "<tr><th></th><th>in the model</th><th>in the recording</th></tr>"
    return f"<h2>Numbers of the model that are off</h2><table>{head}{rows}</table>"


def _not_testable(diagnosis: Diagnosis) -> str:
    if not diagnosis.not_testable:
        return ""
    rows = "".join(
        f"<tr><td>{escape(name)}</td><td>{escape(why)}</td></tr>"
        for name, why in diagnosis.not_testable.items()
    )
    return f"<h2>What this plan could not have shown</h2><table>{rows}</table>"
