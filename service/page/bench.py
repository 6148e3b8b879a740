"""The bench at a glance, and what its camera sees while a sweep runs."""

from collections.abc import Awaitable, Callable, Sequence

from nicegui import ui

from service.owner.messages import DeviceLook
from service.page.figures.live import profile, waterfall
from service.page.frame import keep_fresh, view
from service.page.kept_dark import draw_kept_dark
from service.page.live import Live
from service.page.run_stand import Tail, name_of, stand
from service.page.tables import facts, numbers
from service.page.visitor import Visitor, say
from service.store.keys import Scope

_MAY_DIFFER = "A run has the bench: lamps may burn now, whatever stands here."
_LIVE_S = 0.5
_STATE_S = 1.0


@view("/")
async def show(visitor: Visitor) -> None:
    """Devices on the left, the running sweep on the right."""
    with ui.element("div").classes("df-columns"):
        with ui.element("section").classes("df-card df-side").props('aria-label="Devices"'):
            await _devices(visitor)
        with ui.element("section").classes("df-card").props('aria-label="Live"'):
            _sweep(visitor)


async def _devices(visitor: Visitor) -> None:
    keeper = visitor.parts.keeper
    if keeper is None:
        ui.label("This service has no bench; start it with --bench bench.toml.")
        return
    look_whether_dark = draw_kept_dark(visitor, keeper.darkness)
    shown = ui.element("div")
    drawn: list[object] = []

    async def refresh() -> None:
        look_whether_dark()
        stands = (keeper.owner.state, keeper.owner.trouble, keeper.owner.look)
        if drawn != [stands]:
            drawn[:] = [stands]
            shown.clear()
            with shown:
                ui.label(keeper.owner.bench_id).classes("df-subtitle")
                if keeper.owner.state == "busy":
                    ui.label(_MAY_DIFFER).classes("df-warn")
                if keeper.owner.trouble is not None:
                    ui.label(keeper.owner.trouble.message).classes("df-trouble").props("role=alert")
                look = keeper.owner.look
                _draw_devices(() if look is None else look.devices)

    async def look_now() -> None:
        if await visitor.act(Scope.OPERATE, lambda by: visitor.commands().look(by)) is not None:
            say("All devices were asked")

    await refresh()
    keep_fresh(visitor, refresh, _STATE_S)
    ui.button("Ask all devices", on_click=look_now).props("outline no-caps")
    ui.label(
        "As they were when last asked: at the start, by this button, and by safe-off."
    ).classes("df-note")


def _draw_devices(devices: Sequence[DeviceLook]) -> None:
    for device in devices:
        ui.label(device.role.capitalize()).classes("df-device")
        if device.trouble is not None:
            ui.label(device.trouble.message).classes("df-trouble").props("role=alert")
        lamps, others = _lamps(device), _others(device)
        facts({"device": device.identity or "unnamed", **others})
        if lamps:
            numbers("Lamps", ("lamp", "", "current / A", "hours"), lamps)


def _lamps(device: DeviceLook) -> list[tuple[str, ...]]:
    found: list[tuple[str, ...]] = []
    number = 1
    while f"lamp_{number}_on" in device.values:
        current, hours = (device.values[f"lamp_{number}_{n}"] for n in ("current_a", "hours"))
        found.append(
            (
                str(number),
                "on" if device.values[f"lamp_{number}_on"] else "off",
                "–" if current is None else f"{current:.3f}",
                "–" if hours is None else f"{hours:.1f}",
            )
        )
        number += 1
    return found


def _others(device: DeviceLook) -> dict[str, object]:
    units = {"temperature_c": "temperature / °C", "current_a": "current / A"}
    return {
        units.get(name, name): value
        for name, value in device.values.items()
        if not name.startswith("lamp_")
    }


def _sweep(visitor: Visitor) -> None:
    refresh_stand = _stand(visitor)
    ui.label("Line profile").classes("df-subtitle")
    line = ui.plotly(profile(())).classes("df-figure").props('aria-label="Line profile"')
    ui.label("Waterfall").classes("df-subtitle")
    fall = ui.plotly(waterfall(())).classes("df-figure").props('aria-label="Waterfall"')
    live: Live | None = visitor.live
    drawn: list[object] = [None]

    async def refresh() -> None:
        await refresh_stand()
        seen = () if live is None else live.seen()
        if seen and seen[-1] is not drawn[0]:
            drawn[0] = seen[-1]
            line.update_figure(profile(seen))
            fall.update_figure(waterfall(seen))

    keep_fresh(visitor, refresh, _LIVE_S)


def _stand(visitor: Visitor) -> Callable[[], Awaitable[None]]:
    says = ui.label("Nothing runs.").props('role="status"')
    bar = ui.linear_progress(0.0, show_value=False).props('aria-label="Blocks done"')
    runs = visitor.parts.store.runs
    tails: list[Tail] = []

    def look() -> tuple[str, float]:
        run = runs.under_way()
        if run is None:
            return "Nothing runs.", 0.0
        if not tails or tails[0].run_id != run.id:
            tails[:] = [Tail(runs, run.id)]
        tails[0].read_on()
        stands = stand(run, tails[0].progress)
        return f"{name_of(run)}: {stands.text}", stands.share

    async def refresh() -> None:
        found = await visitor.read(look)
        if found is not None:
            says.set_text(found[0])
            bar.set_value(found[1])

    return refresh
