"""The page by hand: a browser presses every button, sees data in figures, and goes nowhere else."""

import json
import time
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import httpx2
import pytest
from playwright.sync_api import Page, expect, sync_playwright
from sqlalchemy import delete

from service.settings import Settings
from service.store.actor import Actor
from service.store.engine import writing_session
from service.store.keys import Scope
from service.store.run_records import FINAL
from service.store.store import Store
from service.store.tables import KeyRow
from tests.service.cli.a_recording import plan_file, recording_file
from tests.service.page.filled import fill_store
from tests.service.page.serving import SIZE, Watched, browser, serving
from tests.service.sequencer.benches import short_plan

__all__ = ["plan_file", "recording_file"]
expect.set_options(timeout=20_000)

VIEWS = ("", "runs", "recordings", "coefficient-sets", "diagnosis", "audit")
SHORT = short_plan(name="short").dumps()
SLOW = short_plan(
    name="slow", settle={"tolerance_percent": 2.0, "stable_for_s": 60.0, "timeout_s": 90.0}
).dumps()
"""Never ends by itself here: after its first dark block the light has to be steady for a minute."""


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory, recording_file: Path) -> Path:
    made = tmp_path_factory.mktemp("page") / "home"
    fill_store(made, recording_file, notes=40)  # more than one page of the log shows
    return made


@pytest.fixture(scope="module")
def store(home: Path) -> Iterator[Store]:
    """The server's store by another way in."""
    with Store.open(Settings(home=home)) as opened:
        yield opened


@pytest.fixture(scope="module")
def watched(home: Path) -> Iterator[Watched]:
    with serving(home) as url, sync_playwright() as playwright:
        started = browser(playwright)
        page = started.new_context(viewport=SIZE, base_url=url).new_page()
        page.set_default_timeout(20_000)
        yield Watched(page, url)
        started.close()


def test_every_button_is_there_and_pressed(watched: Watched, store: Store) -> None:
    """One story, since the bench is one: what is pressed is compared with what there is."""
    for part in (
        the_bench_is_asked,
        a_plan_is_checked,
        a_run_is_held_and_ended,
        a_sweep_is_seen_and_switched_off,
        a_recording_is_calibrated,
        sets_are_compared,
        a_set_lives,
        a_diagnosis_is_read,
        the_log_is_proven,
    ):
        part(watched, store)
    assert watched.seen_buttons <= watched.pressed
    assert {"Safe-off: switch every lamp off now", "Abort", "Revoke"} <= watched.pressed


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


def a_recording_is_calibrated(watched: Watched, store: Store) -> None:
    watched.open("recordings")
    watched.press("Show six flats")
    detail = watched.page.get_by_role("region", name="The chosen recording")
    expect(detail.get_by_text("256 columns, 12 bits")).to_be_visible()
    watched.press("Calibrate")
    expect(watched.page.get_by_text("calibrate: succeeded")).to_be_visible(timeout=60_000)
    watched.press("Photon transfer")
    expect(watched.page.get_by_text("photon-transfer: succeeded")).to_be_visible(timeout=60_000)
    with watched.page.expect_popup() as popup:
        watched.page.get_by_role("link", name="report.html").click()
    expect(popup.value.get_by_role("heading").first).to_be_visible()
    popup.value.close()
    watched.press("Diagnose")
    watched.press("Cancel diagnose")
    expect(watched.page.get_by_text("diagnose: cancelled")).to_be_visible()
    assert len(store.sets.list().items) == 3


def sets_are_compared(watched: Watched, store: Store) -> None:
    newest, other = store.sets.list().items[:2]
    watched.open("coefficient-sets")
    watched.press(f"Show {newest.id[:8]}")
    for name in ("DN0", "VE", "QE"):
        watched.wait_for_data(name, 256)
    watched.page.get_by_label("Compare with").click()
    watched.page.get_by_role("option", name=other.id[:8]).click()
    for name in ("DN0", "VE", "QE"):
        watched.wait_for_data(f"Difference in {name}", 256)
    watched.press("Clear")
    expect(watched.page.locator(".js-plotly-plot")).to_have_count(3)


def a_set_lives(watched: Watched, store: Store) -> None:
    page, (newest, *_) = watched.page, store.sets.list().items
    watched.press("Verify")
    chosen = page.get_by_role("region", name="The chosen set")
    expect(chosen.get_by_text(", verified")).to_be_visible()
    watched.press("Certify")
    expect(page.get_by_role("alert").get_by_text("reason")).to_be_visible()
    watched.press("Close")
    page.get_by_label("Reason").fill("lamp certificate 17")
    watched.press("Certify")
    expect(chosen.get_by_text(", certified")).to_be_visible()
    page.get_by_label("Reason").fill("the lamp had aged")
    watched.press("Revoke")
    expect(chosen.get_by_text(", revoked")).to_be_visible()
    life = [(each.after, each.by, each.reason) for each in store.sets.get(newest.id).transitions]
    assert life[1:] == [
        ("verified", "local", ""),
        ("certified", "local", "lamp certificate 17"),
        ("revoked", "local", "the lamp had aged"),
    ]


def a_diagnosis_is_read(watched: Watched, store: Store) -> None:
    watched.open("diagnosis")
    digest = store.recordings.list().items[-1].digest
    watched.press(f"Show {digest[:8]}")
    expect(watched.page.get_by_text("Verdict: cancelled")).to_be_visible()
    watched.page.get_by_role("button", name=f"Show {digest[:8]}").last.click()
    expect(watched.page.get_by_text("Verdict: explained")).to_be_visible()
    expect(watched.page.get_by_text("interpixel_capacitance 3 %")).to_be_visible()
    watched.wait_for_data("Deviance before and after", 1)


def the_log_is_proven(watched: Watched, store: Store) -> None:
    watched.open("audit")
    watched.press("Verify")
    number, digest = store.audit.verify()
    expect(watched.page.get_by_text(f"Whole: {number} entries")).to_be_visible()
    expect(watched.page.get_by_text(digest)).to_be_visible()
    watched.press("Next page")
    watched.press("Previous page")
    watched.press("Last page")
    watched.press("First page")


def test_each_view_fits_is_reached_by_keyboard_and_names_its_parts(watched: Watched) -> None:
    for path in VIEWS:
        watched.open(path)
        width = watched.page.evaluate("() => document.documentElement.scrollWidth")
        assert width <= SIZE["width"], path
        nameless = watched.page.evaluate(
            """() => [...document.querySelectorAll('button, a[href], input, textarea, select')]
            .filter(e => e.offsetParent !== null && e.type !== 'hidden')
            .filter(e => !(e.innerText || e.ariaLabel || e.labels?.length || e.title
                           || e.closest('.modebar'))).map(e => e.outerHTML)"""
        )
        assert nameless == []
        reached = [focused(watched.page) for _ in range(12)]
        assert reached[0] == "Skip to the content"
        assert "Safe-off: switch every lamp off now" in reached


def focused(page: Page) -> str:
    page.keyboard.press("Tab")
    name: str = page.evaluate(
        "() => document.activeElement.ariaLabel || document.activeElement.innerText"
    )
    return name.strip()


def test_browsers_are_told_what_the_page_may_load(watched: Watched, store: Store) -> None:
    """Behind all that guards the service; what a job left is held to less still."""
    (job,) = (job for job in store.jobs.list().items if job.kind == "photon-transfer")
    report = f"/page/jobs/{job.id}/files/report.html"
    for path, policy in (
        ("/page/", "default-src 'self'; "),
        (report, "sandbox; default-src 'none'"),
    ):
        headers = watched.page.request.get(path).headers
        assert headers["content-security-policy"].startswith(policy)
        assert headers["referrer-policy"] == "same-origin"
        assert headers["x-frame-options"] == "DENY"


def test_pages_of_other_sites_neither_send_its_forms_nor_open_its_socket(watched: Watched) -> None:
    socket = f"{watched.url}/page/_nicegui_ws/socket.io/?EIO=4&transport="
    upgrade = {
        "Connection": "Upgrade",
        "Upgrade": "websocket",
        "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==",
        "Sec-WebSocket-Version": "13",
    }
    for origin in ("http://evil.example", "null", f"{watched.url}.evil.example"):
        foreign = {"Origin": origin}
        form = httpx2.post(f"{watched.url}/page/sign-out", headers=foreign)
        assert (form.status_code, form.json()["code"]) == (403, "foreign-page")
        opened = httpx2.get(f"{socket}websocket", headers={**upgrade, **foreign})
        assert opened.status_code == 403
        assert httpx2.get(f"{socket}polling", headers=foreign).status_code == 400


def test_views_lead_to_each_other(watched: Watched) -> None:
    watched.open("")
    for name, path in (("Runs", "runs"), ("Audit", "audit"), ("Bench", "")):
        watched.page.get_by_role("link", name=name, exact=True).click()
        watched.page.wait_for_url(f"**/page/{path}")
        expect(watched.page.get_by_role("heading", name=name)).to_be_visible()


def test_a_key_is_asked_for_once_there_is_one_and_allows_what_its_scope_does(
    watched: Watched, store: Store
) -> None:
    page = watched.page
    watched.open("audit")
    key = store.keys.create("bob", Scope.READ, expires_at=None, by=Actor("root"))[1]
    try:
        page.wait_for_url("**/page/sign-in")  # whoever looks on is asked, too
        sign_in(page, f"{key[:-4]}nope")
        expect(page.get_by_role("alert")).to_contain_text("not known")
        sign_in(page, key)
        page.wait_for_url("**/page/")
        cookie = page.context.cookies()[0]
        assert (cookie["httpOnly"], cookie["sameSite"], cookie["path"]) == (True, "Strict", "/page")
        assert key not in cookie["value"]
        watched.press("Safe-off: switch every lamp off now")
        expect(page.get_by_role("alert").get_by_text("needs the scope operate")).to_be_visible()
        watched.press("Sign out bob")
        page.wait_for_url("**/page/sign-in")
        page.goto("/page/runs")
        page.wait_for_url("**/page/sign-in")
        sign_in(page, key)
        page.wait_for_url("**/page/")
        store.keys.revoke(store.keys.list()[0].id, by=Actor("root"))
        page.wait_for_url("**/page/sign-in")
    finally:
        with writing_session(store._engine) as session:
            session.execute(delete(KeyRow))
        page.context.clear_cookies()
    watched.errors[:] = [e for e in watched.errors if "401" not in e]  # the refused key, as meant


def sign_in(page: Page, key: str) -> None:
    page.get_by_label("Key").fill(key)
    page.get_by_role("button", name="Sign in").click()


def test_nothing_left_the_machine_and_no_error_was_told(watched: Watched) -> None:
    """Of all that the tests before this one did."""
    hosts = {urlsplit(url).hostname for url in watched.requests if not url.startswith("data:")}
    assert hosts == {"127.0.0.1"}
    assert watched.errors == []
