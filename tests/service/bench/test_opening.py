import os
import signal
import threading
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from calib.errors import DarkflatError
from drivers.errors import DeviceBusyError, DeviceError
from drivers.mock.light import MockLight
from service.bench import BenchSettings, open_bench
from service.bench.shielded import shielded


def settings(name: str, **changes: Any) -> BenchSettings:
    return BenchSettings.parse(
        {
            "id": f"open-{os.getpid()}-{name}",
            "camera": {"driver": "mock", "paced": False},
            "light": {"driver": "mock", "tau_s": 0.0, "ramp_s": 0.0},
            "monitor": {"driver": "mock"},
            "shutter": {"driver": "mock"},
            "simulation": {"model": "demo", "lamps": 2},
            **changes,
        }
    )


def targets(world_file: Path) -> list[float]:
    from drivers.mock.world import World

    world = World(world_file)
    try:
        return [lamp.target for lamp in world.state().lamps]
    finally:
        world.close()


def test_leaving_a_bench_leaves_it_dark(tmp_path: Path):
    world = tmp_path / "world"
    with open_bench(settings("dark", simulation={"model": "demo", "world": world})) as bench:
        bench.light.set_level(2)
        assert max(targets(world)) > 0
    assert max(targets(world)) == 0


def test_leaving_by_an_error_leaves_it_dark(tmp_path: Path):
    world = tmp_path / "world"
    given = settings("error", simulation={"model": "demo", "world": world})

    def fail_while_lit() -> None:
        with open_bench(given) as bench:
            bench.light.set_level(2)
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail_while_lit()
    assert max(targets(world)) == 0


def test_a_bench_has_one_owner_and_is_free_afterwards():
    with open_bench(settings("own")), pytest.raises(DeviceBusyError, match="in use by process"):
        open_bench(settings("own"))
    open_bench(settings("own")).close()


def test_a_bench_that_does_not_open_is_free_again():
    wrong = settings("free", simulation={"model": "no-such-preset"})
    with pytest.raises(DarkflatError):
        open_bench(wrong)
    open_bench(settings("free")).close()


def test_closing_twice_is_safe():
    bench = open_bench(settings("twice"))
    bench.close()
    bench.close()


def test_lamps_that_still_burn_are_an_error_and_everything_is_released():
    bench = open_bench(settings("stuck"))
    assert isinstance(bench.light, MockLight)
    bench.light.set_level(1)
    bench.light.stuck.add(1)
    with pytest.raises(DeviceError, match=r"lamp 1.*switch them off by hand") as caught:
        bench.close()
    assert caught.value.code == "lamps-not-off"
    open_bench(settings("stuck")).close()


def test_a_bench_opens_outside_of_the_main_thread():
    opened = []
    thread = threading.Thread(target=lambda: opened.append(open_bench(settings("thread"))))
    thread.start()
    thread.join()
    opened[0].close()


def test_sigterm_unwinds_while_a_bench_is_open_and_is_as_before_afterwards():
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL
    with pytest.raises(SystemExit) as caught, open_bench(settings("term")):
        signal.raise_signal(signal.SIGTERM)
    assert caught.value.code == 128 + signal.SIGTERM
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL


@pytest.mark.parametrize(
    ("number", "ending", "code"),
    [(signal.SIGTERM, SystemExit, 128 + signal.SIGTERM), (signal.SIGINT, KeyboardInterrupt, None)],
    ids=["SIGTERM", "SIGINT"],
)
def test_a_signal_whose_exception_a_library_loses_ends_the_process_all_the_same(
    number: signal.Signals, ending: type[BaseException], code: int | None
):
    def work() -> None:
        with open_bench(settings("lost")) as bench:
            with suppress(ending):  # as Python does where a weak reference calls back
                signal.raise_signal(number)
            assert bench.is_ending

    with pytest.raises(ending) as caught:
        work()
    assert getattr(caught.value, "code", None) == code


def test_a_signal_waits_until_the_lamps_are_off():
    done = []

    def switch_off():
        with shielded():
            signal.raise_signal(signal.SIGINT)
            done.append("lamps off")
        done.append("went on as if nothing had happened")

    with pytest.raises(KeyboardInterrupt):
        switch_off()
    assert done == ["lamps off"]


def test_a_person_is_asked_for_the_cap():
    asked: list[str] = []
    with open_bench(settings("ask", shutter={"driver": "none"}), ask=asked.append) as bench:
        bench.shutter.set_capped(False)
        bench.shutter.set_capped(True)
        bench.shutter.set_capped(True)
        bench.shutter.set_capped(False)
    assert asked == ["Put the cap on the lens.", "Take the cap off the lens."]


def test_without_a_person_the_sentence_says_what_to_do():
    with (
        open_bench(settings("nobody", shutter={"driver": "none"})) as bench,
        pytest.raises(DeviceError, match="lamps_off") as caught,
    ):
        bench.shutter.set_capped(True)
    assert caught.value.code == "no-operator"


def test_darks_by_lamps_off_switch_the_lamps_off():
    shutter = {"driver": "lamps_off", "afterglow_s": 0.0}
    with open_bench(settings("off", shutter=shutter)) as bench:
        assert bench.caps_by_lamps_off
        bench.light.set_level(2)
        bench.shutter.set_capped(True)
        assert bench.light.state().level == 0
