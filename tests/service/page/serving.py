"""The page's server, as people start it, and a browser that looks at it."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, Page, Playwright, expect

from service.bench import BenchSettings
from tests.service.sequencer.benches import in_process

CHROMIUM = "/usr/bin/chromium"
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
SIZE = {"width": 1366, "height": 768}


@contextmanager
def serving(home: Path) -> Iterator[str]:
    """Run `darkflat serve` with a bench in its own process; yield where it is."""
    bench = home.parent / f"{home.name}-bench.toml"
    bench.write_text(_toml(in_process(f"page-{os.getpid()}-{home.name}")))
    hidden = {"PYTEST_CURRENT_TEST"}  # to the page's framework it would say that it is tested
    environment = {name: value for name, value in os.environ.items() if name not in hidden}
    start = "import sys; from service.cli import main; sys.exit(main())"
    command = [sys.executable, "-c", start, "serve", "--port", "0", "--json", "-"]
    with subprocess.Popen(
        [*command, "--bench", str(bench)],
        env={**environment, "DARKFLAT_HOME": str(home)},
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            assert process.stdout is not None
            yield str(json.loads(answer_of(process))["url"])
        finally:
            process.terminate()
            assert process.wait(30) == 0


def answer_of(process: subprocess.Popen[str]) -> str:
    """Return the JSON object that the server prints once it listens."""
    assert process.stdout is not None
    text = ""
    for line in process.stdout:
        text += line
        if line.rstrip() == "}":
            return text
    raise AssertionError(text)


def _toml(settings: BenchSettings) -> str:
    import tomli_w

    content: dict[str, Any] = settings.model_dump(mode="json", exclude_none=True)
    return tomli_w.dumps(content)


def browser(playwright: Playwright) -> Browser:
    """Start Debian's Chromium."""
    return playwright.chromium.launch(executable_path=CHROMIUM, headless=True, args=FLAGS)


_HAS_DATA = """([name, points]) => {
    const plot = document.querySelector(`.js-plotly-plot[aria-label="${name}"]`);
    return (plot?.calcdata ?? []).some(trace => {
        const z = trace[0]?.z;
        const row = Array.from(z ? z[z.length >> 1] : trace.map(point => point.s ?? point.y));
        const known = row.filter(Number.isFinite);
        return known.length >= points && (points < 2 || new Set(known).size > 1);
    });
}"""
"""Of what is really drawn, not of what was sent."""


def _kind(name: str) -> str:
    """Rows have a button each, of which one stands for all; styles put some in capitals."""
    return "Show" if name.startswith("Show ") else name.capitalize()


class Watched:
    """A page of the browser, what was pressed in it, and all that must not happen.

    Attributes:
        requests: Where it went.
        errors: What its console said that was an error or a warning.
        pressed: Buttons, by name.
        seen_buttons: Likewise, of all that there were.
    """

    def __init__(self, page: Page, url: str) -> None:
        self.page = page
        self.url = url
        self.pressed: set[str] = set()
        self.seen_buttons: set[str] = set()
        self.requests: set[str] = set()
        self.errors: list[str] = []
        page.on("request", lambda request: self.requests.add(request.url))
        page.on("websocket", lambda socket: self.requests.add(socket.url))
        page.on("console", self._said)
        page.on("pageerror", lambda error: self.errors.append(str(error)))

    def _said(self, message: Any) -> None:
        if message.type in {"error", "warning"}:
            self.errors.append(f"{message.type}: {message.text} {message.location}")

    def open(self, view: str) -> None:
        """Open a view, and see that it is alive."""
        self.page.goto(f"/page/{view}")
        state = self.page.get_by_role("status").filter(has_text="bench")
        expect(state.first).not_to_be_empty()
        self._look()

    def press(self, name: str) -> None:
        """Press the first button of this name."""
        self._look()
        self.pressed.add(_kind(name))
        self.page.get_by_role("button", name=name, exact=True).first.click()

    def _look(self) -> None:
        """Remember which buttons there are; those in figures' corners are Plotly's own."""
        names = self.page.get_by_role("button").evaluate_all(
            "all => all.filter(e => !e.closest('.modebar')).map(e => e.ariaLabel || e.innerText)"
        )
        self.seen_buttons |= {_kind(name.strip()) for name in names}

    def wait_for_data(self, figure: str, points: int) -> None:
        """Wait until a figure of that name has that many numbers in a row of it, not all equal.

        Of a map, in the one in the middle.
        """
        self.page.wait_for_function(_HAS_DATA, arg=[figure, points])
