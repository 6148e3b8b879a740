"""The world is whole in whatever order processes and threads write and read it."""

import multiprocessing
import struct
import threading
import time
from pathlib import Path

import pytest

from drivers.mock.world import Lamp, World


@pytest.fixture
def world(tmp_path: Path) -> World:
    return World.create(tmp_path / "world", 3, sensor_temperature_c=21.5)


def test_new_world_is_dark_and_uncapped(world: World) -> None:
    state = world.state()
    assert state.emissions() == (0.0, 0.0, 0.0)
    assert not state.capped
    assert state.sensor_temperature_c == 21.5


def test_second_opener_sees_what_the_first_wrote(world: World) -> None:
    other = World(world.path)
    world.drive(1, 0.7)
    world.cap(True)
    world.warm(30.0)
    assert other.state().emissions() == (0.0, 0.7, 0.0)
    assert other.state().capped
    assert other.state().sensor_temperature_c == 30.0


@pytest.mark.parametrize(
    ("at_s", "emission"),
    [(9.0, 0.25), (10.0, 0.25), (12.0, 1.0 - 0.75 / 2.718281828459045), (1e3, 1.0)],
    ids=["before", "start", "one tau", "long after"],
)
def test_lamp_approaches_its_target_exponentially(at_s: float, emission: float) -> None:
    lamp = Lamp(start=0.25, target=1.0, since_s=10.0, tau_s=2.0)
    assert lamp.emission(at_s) == pytest.approx(emission)


def test_redirected_lamp_goes_on_from_where_it_is(world: World) -> None:
    world.drive(0, 1.0)
    world.drive(0, 0.0, tau_s=1000.0)
    lamp = world.state().lamps[0]
    assert (lamp.start, lamp.target) == (1.0, 0.0)


def test_writer_that_died_in_the_middle_is_mended_by_the_next(world: World) -> None:
    world._map[0] |= 1  # an odd sequence: a write is under way
    with pytest.raises(OSError, match="died in the middle"):
        world.state()
    world.drive(0, 1.0)
    assert world.state().lamps[0].target == 1.0


def test_reader_waits_for_a_writer_that_was_put_to_sleep_in_the_middle(world: World) -> None:
    asleep, go_on = threading.Event(), threading.Event()

    def write_slowly() -> None:
        writer = World(world.path)
        with writer._exclusively():
            writer._map[0] |= 1
            asleep.set()
            assert go_on.wait(30)
            writer._write(len(writer._map) - 24, struct.pack("<d", 0.7))  # the last lamp's target

    writing = threading.Thread(target=write_slowly)
    writing.start()
    assert asleep.wait(30)
    threading.Timer(0.2, go_on.set).start()  # long after a reader has looked in vain
    assert world.state().lamps[2].target == 0.7
    writing.join(30)


def _write_pairs(path: Path, lamp: int, stop: Path) -> None:
    world = World(path)
    while not stop.exists():
        for _ in range(50):
            for value in (0.25, 0.75):
                world.drive(lamp, value)


def test_readers_never_see_half_a_write(world: World) -> None:
    # Two processes and a thread of this one write; every lamp read must be a value written.
    stop = world.path.with_name("stop")
    context = multiprocessing.get_context("spawn")
    writers = [context.Process(target=_write_pairs, args=(world.path, i, stop)) for i in (0, 1)]
    writers_here = threading.Thread(target=_write_pairs, args=(world.path, 2, stop))
    for writer in (*writers, writers_here):
        writer.start()
    while 0.0 in {lamp.target for lamp in world.state().lamps}:
        time.sleep(0.01)  # until all of them write
    for _ in range(2000):
        assert {lamp.target for lamp in world.state().lamps} <= {0.25, 0.75}
    stop.touch()
    for writer in (*writers, writers_here):
        writer.join(30)
    assert [writer.exitcode for writer in writers] == [0, 0]
