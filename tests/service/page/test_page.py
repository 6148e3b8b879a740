"""The page by hand: a browser presses every button, sees data in figures, and goes nowhere else."""

from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import httpx2
import pytest
from playwright.sync_api import Page, expect, sync_playwright
from sqlalchemy import delete

from service.page.frame import VIEWS
from service.settings import Settings
from service.store.actor import Actor
from service.store.engine import writing_session
from service.store.keys import Scope
from service.store.store import Store
from service.store.tables import KeyRow
from tests.service.cli.a_recording import plan_file, recording_file
from tests.service.page.filled import fill_store
from tests.service.page.serving import SIZE, Watched, browser, serving
from tests.service.page.story_of_results import RESULTS
from tests.service.page.story_of_runs import RUNS

__all__ = ["plan_file", "recording_file"]
expect.set_options(timeout=60_000)  # a busy machine takes its time


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
        page.set_default_timeout(60_000)
        yield Watched(page, url)
        started.close()


@pytest.mark.timeout(
    900
)  # a browser, a bench and four jobs: on a busy machine five minutes are short
def test_every_button_is_there_and_pressed(watched: Watched, store: Store) -> None:
    """One story, since the bench is one: what is pressed is compared with what there is."""
    for part in (*RUNS, *RESULTS):
        part(watched, store)
    assert watched.seen_buttons <= watched.pressed
    assert {"Safe-off: switch every lamp off now", "Abort", "Revoke"} <= watched.pressed


def test_each_view_fits_is_reached_by_keyboard_and_names_its_parts(watched: Watched) -> None:
    for path in VIEWS:
        watched.open(path.removeprefix("/"))
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
