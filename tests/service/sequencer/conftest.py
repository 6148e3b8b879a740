import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from service.bench import Bench, open_bench
from tests.service.sequencer.benches import in_process


@pytest.fixture
def bench(request: pytest.FixtureRequest) -> Iterator[Bench]:
    name = f"{os.getpid()}-{abs(hash(request.node.nodeid))}"
    with open_bench(in_process(name)) as opened:
        yield opened


@pytest.fixture
def out(tmp_path: Path) -> Path:
    return tmp_path / "sweep.h5"
