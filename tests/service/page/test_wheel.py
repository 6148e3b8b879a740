"""The wheel alone, in an environment without the source tree, serves the page."""

import json
import os
import re
import subprocess
import time
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx2
import pytest
import tomli_w

from service.page.frame import VIEWS
from tests.service.page.serving import answer_of
from tests.service.page.wheel import PACKAGES, ROOT, build, install
from tests.service.sequencer.benches import in_process

_HIDDEN = {"NUMBA_CACHE_DIR", "PYTHONPATH", "PYTEST_CURRENT_TEST", "VIRTUAL_ENV"}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build(tmp_path_factory.mktemp("wheel"))


def test_the_wheel_holds_every_file_of_its_packages_and_none_else(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        held = {name for name in archive.namelist() if ".dist-info/" not in name}
    there = {
        path.relative_to(ROOT).as_posix()
        for package in PACKAGES
        for path in (ROOT / package).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert held == there


def test_what_is_installed_serves_the_page_and_reads_nothing_of_the_sources(
    wheel: Path, tmp_path: Path
) -> None:
    log = tmp_path / "read-of-the-sources"
    programs = install(wheel, tmp_path / "environment", log)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    peek = f"open({str(ROOT / 'pyproject.toml')!r}).close()"
    subprocess.run([programs / "python", "-c", peek], check=True, cwd=elsewhere)
    assert log.read_text().split() == [str(ROOT.resolve() / "pyproject.toml")]  # it would be seen
    log.unlink()
    with serving(programs, elsewhere) as url, httpx2.Client(base_url=url) as client:
        until_ready(client)
        assets = set()
        for path in (*VIEWS, "/sign-in"):
            page = client.get(f"/page{path}")
            assert page.status_code == 200, path
            assets |= set(re.findall(r'"(/page/_nicegui/[^"\\]+\.(?:js|css|mjs|woff2))', page.text))
        assert len(assets) > 5
        for asset in assets:
            assert client.get(asset).status_code == 200, asset
    assert not log.exists(), log.read_text()


def until_ready(client: httpx2.Client) -> None:
    """Return once the store is migrated and the bench open."""
    deadline_s = time.monotonic() + 60.0
    while (answer := client.get("/readyz")).status_code != 200:
        assert time.monotonic() < deadline_s, answer.text
        time.sleep(0.05)


@contextmanager
def serving(programs: Path, folder: Path) -> Iterator[str]:
    """Run the installed `darkflat serve` in `folder`; yield where it is."""
    bench = folder / "bench.toml"
    settings = in_process(f"wheel-{os.getpid()}").model_dump(mode="json", exclude_none=True)
    bench.write_text(tomli_w.dumps(settings))
    environment = {name: value for name, value in os.environ.items() if name not in _HIDDEN}
    with subprocess.Popen(
        [programs / "darkflat", "serve", "--port", "0", "--json", "-", "--bench", bench],
        env={**environment, "DARKFLAT_HOME": str(folder / "home")},
        cwd=folder,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            yield str(json.loads(answer_of(process))["url"])
        finally:
            process.terminate()
            assert process.wait(30) == 0
