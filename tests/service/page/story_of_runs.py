"""The bench by hand: asked, given a plan, held, and switched off."""

import json
import time

from playwright.sync_api import expect

from service.store.run_records import FINAL
from service.store.store import Store
from tests.service.page.serving import Watched
from tests.service.sequencer.benches import short_plan

SHORT = short_plan(name="short").dumps()
SLOW = short_plan(
    name="slow", settle={"tolerance_percent": 2.0, "stable_for_s": 60.0, "timeout_s": 90.0}
).dumps()
"""Never ends by itself here: after its first dark block the light has to be steady for a minute."""


def the_bench_is_asked(watched: Watched, store: Store) -> None:
    watched.open("")
    expect(watched.page.get_by_role("status").get_by_text("bench idle")).to_be_visible(
        timeout=60_000
    )
    expect(watched.page.get_by_role("table", name="Lamps").get_by_text("off")).to_have_count(3)
    watched.press("Ask all devices")
    expect(watched.page.get_by_text("All devices were asked")).to_be_visible()


def a_plan_is_checked(watched: Watched, store: Store) -> None:
    watched.open("runs")
    plan = watched.page.get_by_label("Plan (TOML or JSON)")
    plan.fill("lights = 3")
    watched.press("Validate")
    expect(watched.page.get_by_role("alert").get_by_text("lights")).to_be_visible()
    watched.press("Close")
    for written in (SHORT, json.dumps(short_plan().model_dump(mode="json"))):
        plan.fill(written)
        watched.press("Validate")
        expect(watched.page.get_by_text("4 blocks, about")).to_be_visible()
    assert not store.runs.list().items


def a_run_is_held_and_ended(watched: Watched, store: Store) -> None:
    page = watched.page
    page.get_by_label("Plan (TOML or JSON)").fill(SLOW)
    watched.press("Start")
    run = page.get_by_role("region", name="The chosen run")
    stands = run.get_by_role("status")
    expect(stands).to_contain_text("running, ")
    watched.press("Pause")
    expect(stands).to_contain_text("paused, ")
    watched.press("Resume")
    expect(stands).to_contain_text("running, ")
    watched.press("Abort")
    expect(stands).to_contain_text("cancelled, ")
    expect(run.get_by_role("cell", name="cancelled", exact=True)).to_be_visible()
    page.get_by_label("Plan (TOML or JSON)").fill(SHORT)
    watched.press("Start")
    expect(stands).to_contain_text("succeeded, 4 of 4 blocks")
    watched.press("Show slow")
    expect(run.get_by_text("Run slow")).to_be_visible()
    watched.press("Show short")
    page.get_by_role("link", name="Its recording").click()
    expect(
        page.get_by_role("region", name="The chosen recording").get_by_text("short")
    ).to_be_visible()


def a_sweep_is_seen_and_switched_off(watched: Watched, store: Store) -> None:
    watched.open("runs")
    watched.page.get_by_label("Plan (TOML or JSON)").fill(SLOW)
    watched.press("Start")
    watched.open("")
    expect(watched.page.get_by_text("slow: running")).to_be_visible()
    watched.wait_for_data("Line profile", 32)
    watched.wait_for_data("Waterfall", 32)
    watched.press("Safe-off: switch every lamp off now")
    expect(watched.page.get_by_text("Every lamp is off, and reads back as off")).to_be_visible()
    deadline = time.monotonic() + 10.0
    while (run := store.runs.list(limit=1).items[0]).state not in FINAL:
        assert time.monotonic() < deadline
    assert run.state == "cancelled"
    assert store.audit.list(limit=9).items[0].action in {"bench.safe-off", "run.cancelled"}


def the_bench_is_released(watched: Watched, store: Store) -> None:
    page = watched.page
    expect(page.get_by_role("status").get_by_text("bench idle · kept dark")).to_be_visible()
    watched.open("")
    expect(page.get_by_text("Kept dark since")).to_be_visible()
    watched.press("Release the bench")
    expect(page.get_by_text("The bench is released: runs begin")).to_be_visible()
    expect(page.get_by_text("Kept dark since")).to_be_hidden()
    assert store.audit.list(limit=1).items[0].action == "bench.release"


RUNS = (
    the_bench_is_asked,
    a_plan_is_checked,
    a_run_is_held_and_ended,
    a_sweep_is_seen_and_switched_off,
    the_bench_is_released,
)
