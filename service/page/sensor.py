"""Sensor: what photon transfers and transfer functions found, as figures with their residuals."""

import json
from collections.abc import Mapping
from typing import Any, Final

from nicegui import ui

from calib.recording import content_addressed
from service.page.figures import photon_transfer, transfer
from service.page.figures.plot import Figure
from service.page.frame import view
from service.page.job_files import draw_files
from service.page.listed_jobs import keep_listed
from service.page.tables import facts, table, text
from service.page.visitor import Visitor
from service.store.records import JobRecord

_KINDS: Final = {"photon-transfer": "Photon transfer", "transfer-function": "MTF"}
_BARS = (
    "Bars and bands are two standard uncertainties (k = 2), of the points alone. Grey flats have no"
    " part in the line, which is EMVA 1288's; clipped ones have no residual."
)
_FIGURES: Final = {
    "system_gain_dn_per_e": "system gain",
    "read_noise_e": "read noise",
    "saturation_capacity_e": "saturation",
    "linearity_error_percent": "linearity error",
    "dsnu_e": "DSNU",
    "prnu_percent": "PRNU",
}


@view("/sensor")
async def show(visitor: Visitor) -> None:
    """The jobs on the left, the figures of the chosen one on the right."""
    result = _Result(visitor)
    with ui.element("div").classes("df-columns"):
        with ui.element("section").classes("df-card df-side-wide").props('aria-label="Results"'):
            listed = table(
                {"kind": "what", "of": "of", "state": "state", "at": "asked"},
                label="Photon transfers and transfer functions, newest first",
                show=result.show,
                rows=5,
            )
            ui.label(
                "A photon transfer is started from a recording, a transfer function by the API:"
                " POST /v1/transfer-functions."
            ).classes("df-note")
            result.draw_facts()
        with ui.element("section").classes("df-card").props('aria-label="Figures"'):
            result.draw_figures()
    await keep_listed(visitor, listed, _KINDS, _row, result.show)


def _row(job: JobRecord) -> dict[str, object]:
    return {
        "key": job.id,
        "name": f"{_KINDS[job.kind]} {job.id[:8]}",
        "kind": _KINDS[job.kind],
        "of": _subject(job),
        "state": job.state,
        "at": text(job.submitted_at),
    }


def _subject(job: JobRecord) -> str:
    """Return what a job was about: a recording's digest, or how the scan was reduced."""
    recording = job.request.get("recording")
    return str((job.result or {}).get("method", "a scan") if recording is None else recording[:8])


class _Result:
    """The chosen job."""

    def __init__(self, visitor: Visitor) -> None:
        self._visitor = visitor

    def draw_facts(self) -> None:
        self._facts = ui.element("div").props('role="region" aria-label="The chosen result"')

    def draw_figures(self) -> None:
        self._figures = ui.element("div")
        with self._figures:
            ui.label("Show a result to see its figures.").classes("df-note")

    async def show(self, job_id: str) -> None:
        job = await self._visitor.read(lambda: self._visitor.parts.store.jobs.get(job_id))
        if job is None or job.kind not in _KINDS:
            return
        drawn = await self._visitor.read(lambda: _drawn(self._visitor, job))
        self._facts.clear()
        self._figures.clear()
        with self._facts:
            _draw_facts(job)
            draw_files(self._visitor, job.id)
        with self._figures:
            with ui.element("div").classes("df-pairs"):
                for name, figure in (drawn or {}).items():
                    ui.plotly(figure).classes("df-figure").props(f'aria-label="{name}"')
            ui.label(_BARS if drawn else _WITHOUT).classes("df-note")


_WITHOUT = "This result has no figures: its job is not done, failed, or left maps alone."


def _drawn(visitor: Visitor, job: JobRecord) -> dict[str, Figure]:
    """Return the figures of what a job left, by name."""
    paths = {each.name: each.path for each in visitor.parts.runner.files.of(job.id)}
    if "data-sheet.json" in paths:
        return _of_sheet(json.loads(paths["data-sheet.json"].read_text("utf-8")))
    if "transfer-function.h5" in paths:
        return _of_transfer(*content_addressed.read(paths["transfer-function.h5"]))
    return {}


def _of_sheet(sheet: Mapping[str, Any]) -> dict[str, Figure]:
    points = photon_transfer.Points.of(sheet)
    return {
        "Photon transfer": photon_transfer.mean_variance(points),
        "Linearity": photon_transfer.linearity(points),
        "Photon transfer residuals": photon_transfer.mean_variance_residuals(points),
        "Linearity residuals": photon_transfer.linearity_residuals(points),
    }


def _of_transfer(arrays: transfer.Arrays, metadata: Mapping[str, Any]) -> dict[str, Figure]:
    cuts = transfer.cuts(arrays, metadata)
    drawn = {
        "MTF": transfer.modulus(cuts, float(metadata["pitch_um"])),
        "PTF": transfer.phase(cuts),
    }
    if "line_spread" in arrays:
        return {**drawn, "Line spread": transfer.line_spread(arrays)}
    maps = (transfer.transfer_map(arrays), transfer.point_spread(arrays))
    return {**drawn, "Transfer function": maps[0], "Point spread": maps[1]}


def _draw_facts(job: JobRecord) -> None:
    ui.label(f"{_KINDS[job.kind]} {job.id[:8]}, {job.state}").classes("df-subtitle")
    if job.error_message is not None:
        ui.label(job.error_message).classes("df-trouble")
    answer = job.result or {}
    if not answer:
        return
    of_sheet = job.kind == "photon-transfer"
    facts(_of_sensor(answer) if of_sheet else _of_scan(answer))
    for remark in _remarks(answer):
        ui.label(remark).classes("df-note")


def _of_sensor(answer: Mapping[str, Any]) -> dict[str, object]:
    named = {name: answer[key] for key, name in _FIGURES.items() if key in answer}
    return {"model": answer.get("model"), **{n: _estimate(each) for n, each in named.items()}}


def _estimate(each: Mapping[str, Any]) -> str | None:
    known = each["value"] is not None
    return f"{each['value']:.5g} ± {each['std']:.2g} {each['unit']}" if known else None


def _remarks(answer: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the warnings, and before them why a figure is unknown where they do not say that."""
    warnings = [str(each) for each in answer.get("warnings", ())]
    reasons = (answer.get(key, {}).get("reason") for key in _FIGURES)
    untold = [r for r in reasons if r and not any(w.startswith(r) for w in warnings)]
    return tuple(dict.fromkeys((*untold, *warnings)))


def _of_scan(answer: Mapping[str, Any]) -> dict[str, object]:
    zeros = zip("xy", answer["first_zero_per_mm"], answer["first_zero_std_per_mm"], strict=True)
    nyquist = answer["mtf_at_nyquist"]
    found = {f"first zero along {axis} / (1/mm)": (at, std) for axis, at, std in zeros}
    found |= {f"MTF at Nyquist along {axis}": (nyquist[axis], nyquist["std"]) for axis in "xy"}
    told = {
        name: None if value is None else f"{value:.5g} ± {std:.2g}"
        for name, (value, std) in found.items()
    }
    return {"method": answer["method"], **told}
