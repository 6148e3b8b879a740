"""Lamp hours are counted while lamps burn, and are never half written."""

import json
import os
from pathlib import Path

import pytest

from calib.errors import InputError
from drivers.serial.lamp_hours import LampHours


class Clock:
    def __init__(self) -> None:
        self.now_s = 1000.0

    def __call__(self) -> float:
        return self.now_s


@pytest.fixture
def clock() -> Clock:
    return Clock()


def test_counts_only_while_burning(clock: Clock) -> None:
    hours = LampHours(None, range(1, 3), clock=clock)
    hours.seen({1: True})
    clock.now_s += 1800
    assert hours.hours(1) == pytest.approx(0.5)
    hours.seen({1: False})
    clock.now_s += 3600
    assert hours.hours(1) == pytest.approx(0.5)
    assert hours.hours(2) == 0


def test_goes_on_from_the_file(tmp_path: Path, clock: Clock) -> None:
    path = tmp_path / "hours.json"
    path.write_text('{"1": 12.5, "7": 3.0}')
    hours = LampHours(path, range(1, 3), clock=clock)
    hours.seen({1: True})
    clock.now_s += 7200
    hours.seen({1: False})
    assert json.loads(path.read_text()) == {"1": 14.5, "2": 0.0, "7": 3.0}


def test_saves_once_a_minute_while_nothing_changes(tmp_path: Path, clock: Clock) -> None:
    path = tmp_path / "hours.json"
    hours = LampHours(path, range(1, 2), clock=clock)
    hours.seen({1: True})
    clock.now_s += 59
    hours.seen({1: True})
    assert json.loads(path.read_text())["1"] == 0
    clock.now_s += 2
    hours.seen({1: True})
    assert json.loads(path.read_text())["1"] == pytest.approx(61 / 3600)


def test_interrupted_save_leaves_the_old_file(
    tmp_path: Path, clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "hours.json"
    hours = LampHours(path, range(1, 2), clock=clock)
    hours.save()
    before = path.read_text()

    def full(_: int) -> None:
        raise OSError("no space left on device")

    monkeypatch.setattr(os, "fsync", full)
    clock.now_s += 3600
    with pytest.raises(OSError, match="no space"):
        hours.seen({1: True})
    assert path.read_text() == before


@pytest.mark.parametrize("text", ["", "[1]", '{"one": 1}', '{"1": "x"}', '{"1": -1}', '{"1": NaN}'])
def test_file_that_is_none_is_refused_and_kept(tmp_path: Path, text: str) -> None:
    path = tmp_path / "hours.json"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        LampHours(path, range(1, 3))
    assert caught.value.code == "lamp-hours-unreadable"
    assert path.read_text() == text
