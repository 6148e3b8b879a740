"""One run: how far it is, what can be done with it, and what it said."""

from collections.abc import Callable

from nicegui import ui

from service.page.run_stand import Tail, name_of, stand
from service.page.tables import facts, fill, table, text
from service.page.visitor import Visitor
from service.runs.commands import RunCommands
from service.store.actor import Actor
from service.store.keys import Scope
from service.store.run_records import FINAL, RunEvent, RunRecord

Command = Callable[[RunCommands, str, Actor], RunRecord]
_COMMANDS: dict[str, Command] = {
    "Pause": lambda commands, run_id, by: commands.pause(run_id, by),
    "Resume": lambda commands, run_id, by: commands.resume(run_id, by),
    "Abort": lambda commands, run_id, by: commands.abort(run_id, by),
}
_POSSIBLE: dict[str, frozenset[str]] = {
    "Pause": frozenset({"running"}),
    "Resume": frozenset({"pausing", "paused", "interrupted", "failed", "cancelled"}),
    "Abort": frozenset({"queued", "running", "pausing", "paused", "interrupted"}),
}


class RunDetail:
    """Shows the run that was chosen last; nothing before one was."""

    def __init__(self, visitor: Visitor) -> None:
        self._visitor = visitor
        self._tail: Tail | None = None
        self._stood: RunRecord | None = None

    def draw_below(self) -> None:
        """Draw it here."""
        self._all = ui.element("div").props('role="region" aria-label="The chosen run"')
        self._all.set_visibility(False)
        with self._all:
            self._title = ui.label().classes("df-subtitle")
            self._says = ui.label().props('role="status"')
            self._bar = ui.linear_progress(0.0, show_value=False).props('aria-label="Blocks done"')
            with ui.row().classes("df-actions"):
                self._buttons = {name: self._button(name) for name in _COMMANDS}
            self._facts = ui.element("div")
            ui.label("Events, newest first").classes("df-subtitle")
            columns = {"name": "no.", "at": "at", "kind": "kind", "said": "what"}
            self._events = table(columns, label="Events of the run", rows=6)

    async def show(self, run_id: str) -> None:
        """Show this run from now on."""
        self._tail, self._stood = Tail(self._visitor.parts.store.runs, run_id), None
        await self.refresh()

    async def refresh(self) -> None:
        """Show what is new of it."""
        tail = self._tail
        if tail is None:
            return

        def look() -> tuple[RunRecord, bool]:
            return self._visitor.parts.store.runs.get(tail.run_id), tail.read_on()

        found = await self._visitor.read(look)
        if found is None:
            self._tail = None
            return
        run, is_new = found
        if is_new or run != self._stood:
            self._stood = run
            self._draw(run, tail)

    def _draw(self, run: RunRecord, tail: Tail) -> None:
        self._all.set_visibility(True)
        stands = stand(run, tail.progress)
        self._title.set_text(f"Run {name_of(run)}")
        self._says.set_text(stands.text)
        self._bar.set_value(stands.share)
        for name, button in self._buttons.items():
            button.set_enabled(run.state in _POSSIBLE[name])
        self._facts.clear()
        with self._facts:
            _draw_outcome(run)
        fill(self._events, [_row(event) for event in reversed(tail.events)])

    def _button(self, name: str) -> ui.button:
        async def press() -> None:
            tail = self._tail
            if tail is None:
                return
            await self._visitor.act(
                Scope.OPERATE,
                lambda by: _COMMANDS[name](self._visitor.commands(), tail.run_id, by),
            )
            await self.refresh()

        return ui.button(name, on_click=press).props("outline no-caps")


def _draw_outcome(run: RunRecord) -> None:
    if run.error_message is not None:
        ui.label(run.error_message).classes("df-trouble")
    if run.state in FINAL:
        result = run.result or {}
        facts(
            {
                "attempts": run.attempts,
                "frames": result.get("frames"),
                "lost frames": result.get("lost_frames"),
                "notes": "; ".join(result.get("notes", ())),
                "finished": run.finished_at,
            }
        )
    if run.recording_digest is not None:
        ui.link("Its recording", f"/recordings?recording={run.recording_digest}")


def _row(event: RunEvent) -> dict[str, object]:
    content = event.content
    if event.kind == "state":
        said = str(content.get("state")) + (
            f": {content['error'][1]}" if content.get("error") else ""
        )
    elif event.kind == "progress":
        said = (
            f"{content.get('blocks_done')} of {content.get('blocks_total')} blocks,"
            f" {content.get('doing')}"
        )
    else:
        said = "; ".join(f"{name}: {value}" for name, value in content.items())
    return {
        "key": event.number,
        "name": event.number,
        "at": text(event.at),
        "kind": event.kind,
        "said": said,
    }
