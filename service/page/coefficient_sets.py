"""Coefficient sets: their curves, their lives, and by how much two of them differ."""

from nicegui import ui

from service.page.frame import keep_fresh, view
from service.page.set_curves import draw_comparison, draw_curves
from service.page.set_life import draw_life
from service.page.tables import facts, fill, table, text
from service.page.visitor import Visitor
from service.store.records import SetRecord

_REFRESH_S = 1.5
_SHOWN = 200


@view("/coefficient-sets")
async def show(visitor: Visitor) -> None:
    """The table and what may be done on the left, curves on the right."""
    with ui.element("div").classes("df-columns"):
        with ui.element("section").classes("df-card df-side-wide").props('aria-label="Sets"'):
            detail = _Detail(visitor)
            listed = table(
                {"name": "id", "state": "state", "camera": "camera", "band": "band", "at": "added"},
                label="Coefficient sets, newest first",
                show=detail.show,
                rows=5,
            )
            detail.draw_below()
        with ui.element("section").classes("df-card").props('aria-label="Curves"'):
            detail.draw_curves()

    async def refresh() -> None:
        store = visitor.parts.store
        found = await visitor.read(lambda: store.sets.list(limit=_SHOWN).items) or ()
        fill(listed, [_row(each) for each in found])
        detail.offer(found)

    if visitor.asked("set"):
        await detail.show(visitor.asked("set"))
    await refresh()
    keep_fresh(visitor, refresh, _REFRESH_S)


def _row(record: SetRecord) -> dict[str, object]:
    return {
        "key": record.id,
        "name": record.id[:8],
        "state": str(record.state),
        "camera": record.camera_serial,
        "band": record.band or "–",
        "at": text(record.added_at),
    }


class _Detail:
    """The chosen set, and the one that it is compared with."""

    def __init__(self, visitor: Visitor) -> None:
        self._visitor = visitor
        self._shown = ""

    def draw_below(self) -> None:
        self._all = ui.element("div").props('role="region" aria-label="The chosen set"')

    def draw_curves(self) -> None:
        self._other = ui.select({}, label="Compare with", clearable=True, on_change=self._redraw)
        self._other.props("outlined dense").classes("df-compare")
        self._curves = ui.element("div")
        with self._curves:
            ui.label("Show a set to see its curves.").classes("df-note")

    def offer(self, records: tuple[SetRecord, ...]) -> None:
        """Let the chosen set be compared with any other one."""
        names = {r.id: f"{r.id[:8]} ({r.state})" for r in records if r.id != self._shown}
        if names != self._other.options:
            self._other.set_options(names)

    async def show(self, set_id: str) -> None:
        store = self._visitor.parts.store
        record = await self._visitor.read(lambda: store.sets.get(set_id))
        if record is None:
            return
        self._shown = record.id
        self._all.clear()
        with self._all:
            ui.label(f"Set {record.id[:8]}, {record.state}").classes("df-subtitle")
            ui.link("Before and after its correction", f"/correction?set={record.id}")
            draw_life(self._visitor, record, self.show)
            facts(_summary(record))
        await self._redraw()

    async def _redraw(self) -> None:
        if not self._shown:
            return
        files, other = self._visitor.parts.store.sets.files, self._other.value
        first = await self._visitor.read(lambda: files.load(self._shown))
        second = await self._visitor.read(lambda: files.load(other)) if other else None
        self._curves.clear()
        with self._curves:
            if first is not None and second is not None:
                draw_comparison(first, second)
            elif first is not None:
                draw_curves(first)


def _summary(record: SetRecord) -> dict[str, object]:
    summary, held = record.summary, record.certification
    at_axis = summary.get("responsivity_at_axis") or {}
    validity = "" if held is None else f"{held.valid_from:%Y-%m-%d} to {_end(held.until)}"
    return {
        "valid for": validity,
        "camera": f"{record.camera_serial}, {record.gain_db:g} dB, {record.bit_depth} bits",
        "columns": f"{summary.get('valid_columns')} of {record.columns} valid",
        "mean DN0 / DN": summary.get("mean_dark_offset_dn"),
        "axis, column": summary.get("axis_column"),
        "edge fall / %": summary.get("edge_fall_percent"),
        "QE at the axis": f"{text(at_axis.get('value'))} ± {text(at_axis.get('std'))}"
        f" {at_axis.get('unit', '')}",
        "system gain / (DN/e-)": summary.get("system_gain_dn_per_e"),
        "read noise / e-": summary.get("read_noise_e"),
        "last word": f"{record.transitions[-1].by}: {record.transitions[-1].reason or '–'}",
    }


def _end(until: object) -> str:
    return "further notice" if until is None else f"{until:%Y-%m-%d}"
