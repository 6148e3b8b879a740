"""Options and markers of this project's own tests: `--bench` names a real bench.

With DARKFLAT_NO_SKIPS=1 a skipped test fails: where everything is installed, a skip hides a defect.
"""

import os
import signal
from collections.abc import Generator, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from tests import draws

draws.settle()


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--bench",
        metavar="BENCH.toml",
        type=Path,
        default=None,
        help="run the tests marked `hardware` on this bench; its lamps will burn",
    )


def pytest_configure(config: pytest.Config) -> None:
    """A shell's background job ignores Ctrl-C, and so would all that tests start and interrupt."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    if config.getoption("hypothesis_seed", None) is None:
        config.option.hypothesis_seed = int.from_bytes(os.environ[draws.VARIABLE].encode())


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    terminalreporter.write_line(f"drawn with {draws.VARIABLE}={os.environ[draws.VARIABLE]}")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Give each worker whole files, and one of them all that need the one simulated camera.

    What the tests of a file have in common is then made once, and nobody waits for the camera's
    address. (xdist's own groups are lost with a pytest in which a node's id cannot be changed.)
    """
    from xdist.scheduler import LoadScopeScheduling

    class FilesTogether(LoadScopeScheduling):
        def _split_scope(self, nodeid: str) -> str:
            file = nodeid.partition("::")[0]
            return "camera" if needs_camera(config.rootpath / file) else file

    return FilesTogether(config, log)


@cache
def needs_camera(file: Path) -> bool:
    return "pytest.mark.aravis" in file.read_text("utf-8")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.getoption("--bench") is not None:
        return
    skip = pytest.mark.skip(reason="needs a real bench: --bench BENCH.toml")
    for item in items:
        if item.get_closest_marker("hardware"):
            item.add_marker(skip)


@pytest.fixture
def hardware_bench(request: pytest.FixtureRequest) -> Iterator[Any]:
    """The bench that `--bench` names, opened; dark again afterwards."""
    from service.bench import open_bench

    with open_bench(request.config.getoption("--bench")) as bench:
        yield bench


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Generator[None, pytest.TestReport, pytest.TestReport]:
    report = yield
    if report.skipped and os.environ.get("DARKFLAT_NO_SKIPS") == "1":
        report.outcome = "failed"
    return report
