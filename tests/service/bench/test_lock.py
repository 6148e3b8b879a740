import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from drivers.errors import DeviceBusyError
from service.bench.lock import BenchLock

HOLD = """
import sys, time
from pathlib import Path
from service.bench.lock import BenchLock
lock = BenchLock("b", Path(sys.argv[1]))
lock.acquire()
print("held", flush=True)
time.sleep(60)
"""


def holder(folder: Path) -> subprocess.Popen[str]:
    process = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(folder)], stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "held\n"
    return process


def end(process: subprocess.Popen[str]) -> None:
    process.kill()
    process.communicate()


def test_a_second_process_is_told_who_holds_the_bench(tmp_path: Path):
    process = holder(tmp_path)
    try:
        for _ in range(2):  # being refused must not spoil what the file says
            with pytest.raises(DeviceBusyError, match=f"in use by process {process.pid}") as caught:
                BenchLock("b", tmp_path).acquire()
            assert caught.value.code == "bench-busy"
    finally:
        end(process)


def test_a_holder_that_was_killed_does_not_hold_it_any_more(tmp_path: Path):
    process = holder(tmp_path)
    os.kill(process.pid, signal.SIGKILL)
    end(process)
    assert f'"pid": {process.pid}' in (tmp_path / "darkflat-b.lock").read_text()
    lock = BenchLock("b", tmp_path)
    lock.acquire()
    assert f'"pid": {os.getpid()}' in lock.path.read_text()
    lock.release()


def test_a_bench_that_was_given_back_is_free(tmp_path: Path):
    first, second = BenchLock("b", tmp_path), BenchLock("b", tmp_path)
    first.acquire()
    with pytest.raises(DeviceBusyError, match=f"process {os.getpid()}"):
        second.acquire()
    first.release()
    first.release()
    second.acquire()
    second.release()


def test_two_benches_are_held_at_once(tmp_path: Path):
    first, second = BenchLock("a", tmp_path), BenchLock("b", tmp_path)
    first.acquire()
    second.acquire()
    first.release()
    second.release()


def test_a_link_that_somebody_left_there_is_not_followed(tmp_path: Path):
    (tmp_path / "elsewhere").write_text("precious")
    (tmp_path / "darkflat-b.lock").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(OSError, match="symbolic links"):
        BenchLock("b", tmp_path).acquire()
    assert (tmp_path / "elsewhere").read_text() == "precious"
