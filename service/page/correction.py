"""Correction: what a coefficient set makes of a recording's lines, before and after."""

from collections.abc import Awaitable, Callable, Mapping
from pathlib import Path

from nicegui import ui

from calib.recording.open import open_recording
from service.evaluation.corrected_block import (
    CorrectedBlock,
    block_in_the_middle,
    blocks_to_show,
    corrected_block,
)
from service.page.figures import correction as figures
from service.page.figures.plot import Figure
from service.page.frame import view
from service.page.tables import facts, numbers, text
from service.page.visitor import Visitor
from service.store.records import RecordingRecord, SetRecord
from service.store.store import Store

_SHOWN = 200
_ABOUT = (
    "After the correction the mean line can be no smoother than its noise; what is above it is what"
    " the set leaves. Single lines: the median. Bands: two standard uncertainties (k = 2), of the"
    " radiance with its scale. Both images span the same share of their medians."
)


@view("/correction")
async def show(visitor: Visitor) -> None:
    """What is chosen and the numbers on the left, figures on the right."""
    chosen = _Chosen(visitor)
    with ui.element("div").classes("df-columns"):
        with ui.element("section").classes("df-card df-side").props('aria-label="What is shown"'):
            chosen.draw_choice()
        with ui.element("section").classes("df-card").props('aria-label="Before and after"'):
            chosen.draw_figures()
    await chosen.begin()


class _Chosen:
    """A set, a recording of the same camera, and one of its blocks."""

    def __init__(self, visitor: Visitor) -> None:
        self._visitor = visitor
        self._store = visitor.parts.store
        self._sets: dict[str, SetRecord] = {}
        self._recordings: dict[str, RecordingRecord] = {}

    def draw_choice(self) -> None:
        self._set = _select("Coefficient set", self._offer_recordings)
        self._recording = _select("Recording", self._offer_blocks)
        self._block = _select("Block", self._redraw)
        self._numbers = ui.element("div").props('role="region" aria-label="Nonuniformity"')

    def draw_figures(self) -> None:
        self._figures = ui.element("div")
        with self._figures:
            ui.label("Choose a set and a recording to see what it corrects.").classes("df-note")

    async def begin(self) -> None:
        """Offer what there is; shown is what the address asks for, else the newest set."""
        sets = await self._visitor.read(lambda: self._store.sets.list(limit=_SHOWN).items)
        kept = await self._visitor.read(lambda: self._store.recordings.list(limit=_SHOWN).items)
        self._sets = {each.id: each for each in sets or ()}
        self._recordings = {each.digest: each for each in kept or ()}
        names = {each.id: f"{each.id[:8]} ({each.state})" for each in self._sets.values()}
        asked = self._recordings.get(self._visitor.asked("recording"))
        alike = [s.id for s in sets or () if asked and s.camera_serial == asked.camera_serial]
        wanted = self._visitor.asked("set") or next(iter(alike), "")
        self._set.set_options(names, value=_first(names, wanted))
        await self._offer_recordings()

    async def _offer_recordings(self) -> None:
        """Offer those of the set's camera; the one that it was made of is shown."""
        record = self._sets.get(self._set.value)
        if record is None:
            return
        names = {
            each.digest: f"{each.name or each.digest[:8]}, {text(each.started_at)}"
            for each in self._recordings.values()
            if each.camera_serial == record.camera_serial
        }
        asked = self._visitor.asked("recording")
        wanted = asked if asked in names else record.recording_digest
        self._recording.set_options(names, value=_first(names, wanted))
        await self._offer_blocks()

    async def _offer_blocks(self) -> None:
        kept = self._recordings.get(self._recording.value)
        if kept is None:
            return
        path = Path(kept.path)
        found = await self._visitor.read(lambda: blocks_to_show(open_recording(path)))
        if not found:
            return
        names = {b.block: f"{b.block}: {b.kind} {b.level:g}, {b.exposure_us:g} µs" for b in found}
        self._block.set_options(names, value=block_in_the_middle(found).block)
        await self._redraw()

    async def _redraw(self) -> None:
        record = self._sets[self._set.value]
        kept, name = self._recordings[self._recording.value], self._block.value
        found = await self._visitor.read(lambda: _corrected(self._store, record, kept, name))
        self._numbers.clear()
        self._figures.clear()
        if found is None:
            return
        with self._numbers:
            _draw_numbers(found, is_own=record.recording_digest == kept.digest)
        with self._figures:
            _draw_figures(found, record.radiance_unit)


def _select(label: str, chosen: Callable[[], Awaitable[None]]) -> ui.select:
    """Return one that calls `chosen` when a person chooses, and not when options are offered."""
    made = ui.select({}, label=label).props("outlined dense").classes("df-wide")
    return made.on("update:model-value", chosen)


def _first(names: Mapping[str, str], wanted: str) -> str | None:
    return wanted if wanted in names else next(iter(names), None)


def _corrected(store: Store, record: SetRecord, kept: RecordingRecord, name: str) -> CorrectedBlock:
    recording, coefficients = open_recording(Path(kept.path)), store.sets.files.load(record.id)
    block = next(each for each in blocks_to_show(recording) if each.block == name)
    is_own = record.recording_digest == kept.digest
    return corrected_block(recording, coefficients, block, is_own=is_own)


def _draw_numbers(shown: CorrectedBlock, *, is_own: bool) -> None:
    rows = [
        (name, f"{each.mean_line:.3f}", f"{each.single_line:.3f}")
        for name, each in (
            ("before: DN", shown.before),
            ("before: DN / VE", shown.without_vignette),
            ("after: radiance", shown.after),
        )
    ]
    ui.label("Standard deviation over the columns / % of the mean").classes("df-subtitle")
    numbers("Nonuniformity before and after", ("", "mean line", "single lines"), rows)
    facts(
        {
            "noise in the mean line / %": f"{shown.noise_percent:.3f}",
            "lines": f"{len(shown.raw_dn)}{', none in the fit' if is_own else ''}",
            "columns": f"{int(shown.used.sum())} of {shown.used.size} used",
        }
    )
    for note in shown.notes:
        ui.label(note).classes("df-warn")
    ui.label(_ABOUT).classes("df-note")


def _draw_figures(shown: CorrectedBlock, unit: str) -> None:
    _draw("Before and after", figures.unevenness(shown))
    with ui.element("div").classes("df-pairs"):
        _draw("Raw profile", figures.raw_profile(shown))
        _draw("Radiance profile", figures.radiance_profile(shown, unit))
        _draw("Raw image", figures.raw_image(shown))
        _draw("Radiance image", figures.radiance_image(shown, unit))


def _draw(name: str, drawn: Figure) -> None:
    ui.plotly(drawn).classes("df-figure-low").props(f'aria-label="{name}"')
