"""Options and markers of this project's own tests: `--bench` names a real bench.

With DARKFLAT_NO_SKIPS=1 a skipped test fails: where everything is installed, a skip hides a defect.
"""

import os
import signal
from collections.abc import Generator, Iterator
from pathlib import Path
from typing import Any

import pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--bench",
        metavar="BENCH.toml",
        type=Path,
        default=None,
        help="run the tests marked `hardware` on this bench; its lamps will burn",
    )


def pytest_configure() -> None:
    """A shell's background job ignores Ctrl-C, and so would all that tests start and interrupt."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    for item in items:
        # One simulated camera at a time can hold the address: its tests share a worker. Those of
        # any other file do, too: what they have in common is made once.
        group = "camera" if item.get_closest_marker("aravis") else item.nodeid.partition("::")[0]
        item.add_marker(pytest.mark.xdist_group(group))
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
