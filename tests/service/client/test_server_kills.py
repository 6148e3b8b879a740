"""`kill -9` of the server while it runs a plan, certifies and takes uploads: nothing is lost.

Every other time the bench's process dies with it, as when the power fails for both.
"""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.service.cli.a_recording import plan_file, recording_file
from tests.service.client.killing import EXPOSURES_US, Killing
from tests.service.client.outliving_lamps import served_with_lamps
from tests.service.served import ROOT

__all__ = ["plan_file", "recording_file"]

DARK_WITHIN_S = 5.0
"""Of the restart: the promise, which the long form measures."""
KINDS = ("run", "certification", "upload")
TWENTY = (10, 10)
"""Kills of each kind, by service: two that are each killed for some minutes."""


def test_a_killed_server_has_lost_nothing_that_it_acknowledged(
    tmp_path: Path, recording_file: Path
) -> None:
    with served_with_lamps(tmp_path, lamps=2, baudrate=115200) as service:
        killing = Killing(service, tmp_path, recording_file, EXPOSURES_US[:2])
        for bench_too in (True, False):
            killing.once(bench_too=bench_too)
        killing.finish()
    assert killing.told.recordings
    assert killing.told.certified
    assert killing.cut["run"]


@pytest.mark.soak
@pytest.mark.parametrize("of_each_kind", TWENTY, ids=("first", "second"))
def test_twenty_kills_of_each_kind_lose_nothing_and_the_lamps_are_off_within_five_seconds(
    tmp_path: Path, recording_file: Path, of_each_kind: int
) -> None:
    with served_with_lamps(tmp_path, lamps=6, baudrate=9600) as service:
        killing, kills = Killing(service, tmp_path, recording_file), 0
        while any(killing.cut[kind] < of_each_kind for kind in KINDS):
            killing.once(bench_too=kills % 2 == 0)
            kills += 1
            assert kills < 30, killing.cut
        print(kills, "kills,", killing.in_words())  # noqa: T201  shown by pytest -rP
        killing.finish()
        asked = [sys.executable, "-c", "from service.cli import main; main()"]
        asked += ["store", "check"]
        environment = {"DARKFLAT_HOME": str(service.home), "PATH": "/usr/bin:/bin"}
        subprocess.run(asked, env=environment, cwd=ROOT, check=True)
    assert max(killing.dark_after_s + killing.dark_alone_after_s) < DARK_WITHIN_S
