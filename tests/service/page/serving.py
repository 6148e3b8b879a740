"""The page's server, as people start it, and a browser that looks at it."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, Page, Playwright

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
            yield str(json.loads(_answer(process))["url"])
        finally:
            process.terminate()
            assert process.wait(30) == 0


def _answer(process: subprocess.Popen[str]) -> str:
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


class Watched:
    """A page of the browser, and all that must not happen in it."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.requests: set[str] = set()
        self.errors: list[str] = []
        page.on("request", lambda request: self.requests.add(request.url))
        page.on("websocket", lambda socket: self.requests.add(socket.url))
        page.on("console", self._said)
        page.on("pageerror", lambda error: self.errors.append(str(error)))

    def _said(self, message: Any) -> None:
        if message.type in {"error", "warning"}:
            self.errors.append(f"{message.type}: {message.text} {message.location}")
