"""Tables whose rows can be shown: each has a button, so that a keyboard reaches it."""

from collections.abc import Awaitable, Callable, Mapping, Sequence
from datetime import datetime
from typing import Any

from nicegui import events, ui

Show = Callable[[str], Awaitable[None]]
_PAGE_ROWS = 8
_BUTTON = """
<q-td :props="props">
  <q-btn dense outline no-caps :label="props.value" :aria-label="props.value + ' ' + props.row.name"
    @click="$parent.$emit('show', props.row.key)" />
</q-td>
"""


def table(
    columns: Mapping[str, str], *, label: str, show: Show | None = None, rows: int = _PAGE_ROWS
) -> ui.table:
    """Return an empty table; its rows hold `key` and `name` besides what the columns show.

    Args:
        columns: Label by field.
        label: What the table is, for who cannot see it.
        show: Called with the `key` of the row whose button is pressed; None: no buttons.
        rows: So many per page.
    """
    shown = [_column(name, text) for name, text in columns.items()]
    if show is not None:
        shown.append({**_column("show", ""), "sortable": False})
    made = ui.table(rows=[], columns=shown, row_key="key", pagination=rows)
    made.props(
        f'flat dense aria-label="{label}" no-data-label="None yet"'
        f' :rows-per-page-options="[{rows}]"'
    ).classes("df-table")
    if show is not None:

        async def pressed(event: events.GenericEventArguments) -> None:
            await show(str(event.args))

        made.add_slot("body-cell-show", _BUTTON)
        made.on("show", pressed)
    return made


def fill(made: ui.table, rows: Sequence[Mapping[str, Any]]) -> None:
    """Show `rows`, where they are other ones than before."""
    new = [{"show": "Show", **row} for row in rows]
    if new != made.rows:
        made.rows = new


def facts(values: Mapping[str, object]) -> None:
    """Show names and values, one under the other."""
    with ui.element("dl").classes("df-facts"):
        for name, value in values.items():
            with ui.element("dt"):
                ui.label(name)
            with ui.element("dd"):
                ui.label(text(value))


def numbers(label: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Show a few numbers side by side: no pages, no buttons."""
    with ui.element("table").classes("df-numbers").props(f'aria-label="{label}"'):
        for tag, row in [("th", head), *(("td", each) for each in rows)]:
            with ui.element("tr"):
                for cell in row:
                    with ui.element(tag):
                        ui.label(cell)


def text(value: object) -> str:
    """Return a value as a person reads it; a dash where there is none."""
    match value:
        case None | "":
            return "–"
        case bool():
            return "yes" if value else "no"
        case float():
            return f"{value:.6g}"
        case datetime():
            return f"{value:%Y-%m-%d %H:%M:%S}"
        case _:
            return str(value)


def _column(name: str, label: str) -> dict[str, Any]:
    return {"name": name, "label": label, "field": name, "align": "left", "sortable": True}
