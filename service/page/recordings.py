"""Recordings: what there is, what one holds, and what is worked out of it."""

from collections.abc import Mapping
from typing import Any

from nicegui import ui

from service.page.frame import keep_fresh, view
from service.page.jobs import JobList
from service.page.recording_work import WORK, RecordingWork
from service.page.tables import facts, fill, table, text
from service.page.visitor import Visitor, say
from service.store.keys import Scope
from service.store.records import RecordingRecord

_REFRESH_S = 1.0
_SHOWN = 200


@view("/recordings")
async def show(visitor: Visitor) -> None:
    """The table, then the chosen recording; jobs beside it."""
    with ui.element("div").classes("df-columns"):
        with ui.element("section").classes("df-card").props('aria-label="Recordings"'):
            detail = _Detail(visitor)
            listed = table(
                {
                    "name": "name",
                    "camera": "camera",
                    "band": "band",
                    "blocks": "blocks",
                    "at": "registered",
                    "by": "by",
                },
                label="Recordings, newest first",
                show=detail.show,
                rows=5,
            )
            detail.draw_below()
        with ui.element("section").classes("df-card df-side").props('aria-label="Jobs"'):
            ui.label("Jobs").classes("df-subtitle")
            jobs = JobList(visitor)

    async def refresh() -> None:
        store = visitor.parts.store
        found = await visitor.read(lambda: store.recordings.list(limit=_SHOWN).items)
        fill(listed, [_row(each) for each in found or ()])
        await jobs.refresh()

    if visitor.asked("recording"):
        await detail.show(visitor.asked("recording"))
    keep_fresh(visitor, refresh, _REFRESH_S)


def _row(kept: RecordingRecord) -> dict[str, object]:
    return {
        "key": kept.digest,
        "name": kept.name or kept.digest[:8],
        "camera": kept.camera_serial,
        "band": kept.band or "–",
        "blocks": len(kept.header.get("blocks", ())),
        "at": text(kept.registered_at),
        "by": kept.registered_by,
    }


class _Detail:
    def __init__(self, visitor: Visitor) -> None:
        self._visitor = visitor

    def draw_below(self) -> None:
        self._all = ui.element("div").props('role="region" aria-label="The chosen recording"')

    async def show(self, digest: str) -> None:
        store = self._visitor.parts.store
        kept = await self._visitor.read(lambda: store.recordings.get(digest))
        if kept is None:
            return
        self._all.clear()
        with self._all:
            ui.label(kept.name or kept.digest[:8]).classes("df-subtitle")
            for warning in kept.warnings:
                ui.label(warning).classes("df-trouble")
            self._work(kept)
            ui.link("Before and after a correction", f"/correction?recording={kept.digest}")
            facts({"digest": kept.digest, "started": kept.started_at, **_camera(kept.header)})
            _blocks(kept.header)

    def _work(self, kept: RecordingRecord) -> None:
        relative = ui.checkbox("Calibrate without radiances: a relative scale")
        with ui.row().classes("df-actions"):
            for work in WORK:
                ui.button(
                    work.name, on_click=lambda work=work: self._start(work, kept, relative.value)
                ).props("outline no-caps")

    async def _start(self, work: RecordingWork, kept: RecordingRecord, relative: bool) -> None:
        job = await self._visitor.act(
            Scope.OPERATE,
            lambda by: work.start(self._visitor.parts, kept.digest, by, relative),
        )
        if job is not None:
            say(f"{work.name} is queued")


def _camera(header: Mapping[str, Any]) -> dict[str, object]:
    camera, source = header.get("camera", {}), header.get("source") or {}
    size = f"{camera.get('columns')} columns, {camera.get('bit_depth')} bits"
    return {
        "camera": f"{camera.get('model', '')} {camera.get('serial', '')}, {size}",
        "gain / dB": camera.get("gain_db"),
        "line period / µs": camera.get("line_period_us"),
        "source": f"{source.get('kind', '–')}, {source.get('radiance_unit', '')}",
    }


def _blocks(header: Mapping[str, Any]) -> None:
    columns = {
        "name": "block",
        "kind": "kind",
        "exposure_us": "exposure / µs",
        "level": "level",
        "lines": "lines",
        "sensor_temperature_c": "temperature / °C",
        "radiance": "radiance",
    }
    made = table(columns, label="Blocks of the recording", rows=7)
    rows = []
    for block in header.get("blocks", ()):
        cells = {name: text(block.get(name)) for name in columns if name != "name"}
        rows.append({"key": block.get("block"), "name": block.get("block"), **cells})
    fill(made, rows)
