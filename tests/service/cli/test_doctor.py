"""`doctor`: what it finds on machines that lack something."""

from collections.abc import Callable
from pathlib import Path

import pytest

from service.doctor.network import look_at_network
from service.doctor.python import is_writable, look_at_python
from service.doctor.serial_ports import look_at_serial
from service.doctor.storage import look_at_storage
from service.doctor.usb import look_at_usb
from service.settings import Settings
from tests.service.cli.answers import Ran
from tests.service.cli.benches import bench_file

Run = Callable[..., Ran]


def test_the_doctor_lists_what_it_looked_at(run: Run) -> None:
    ran = run("doctor", "--json", "-")
    assert ran.status == (0 if ran.json["ok"] else 1)
    topics = {finding["topic"] for finding in ran.json["findings"]}
    assert {"Python", "packages", "Aravis", "serial ports", "socket buffer", "disk"} <= topics
    for finding in ran.json["findings"]:
        assert (finding["state"] == "ok") == (finding["remedy"] == "")


def test_each_device_of_the_bench_is_asked(run: Run, tmp_path: Path) -> None:
    ran = run("doctor", "--bench", bench_file(tmp_path), "--json", "-")
    found = {finding["topic"]: finding["state"] for finding in ran.json["findings"]}
    for device in ("light", "camera", "monitor", "shutter"):
        assert found[f"bench: {device}"] == "ok"


def test_a_device_that_does_not_answer_is_missing_and_the_others_are_asked_all_the_same(
    run: Run, tmp_path: Path
) -> None:
    bench = bench_file(tmp_path)
    text = bench.read_text().replace(
        '[monitor]\ndriver = "mock"\nintegration_s = 0.001',
        f'[monitor]\ndriver = "keithley6485"\nport = "{tmp_path}/nowhere"',
    )
    bench.write_text(text)
    ran = run("doctor", "--bench", bench, "--json", "-")
    assert ran.status == 1
    assert ran.json["missing"] == ["bench: monitor"]
    found = {finding["topic"]: finding["state"] for finding in ran.json["findings"]}
    assert found["bench: camera"] == found["bench: shutter"] == "ok"


def test_a_bad_bench_file_is_missing(run: Run, tmp_path: Path) -> None:
    (tmp_path / "bench.toml").write_text("camera = 3")
    ran = run("doctor", "--bench", tmp_path / "bench.toml", "--json", "-")
    assert (ran.status, ran.json["missing"]) == (1, ["bench file"])


def test_an_aravis_camera_without_aravis_is_missing(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in ("aravis", "examination"):
        monkeypatch.setattr(f"service.doctor.{module}.why_no_aravis", lambda: "no PyGObject")
    assert run("doctor").status == 0
    bench = bench_file(tmp_path)
    bench.write_text(
        bench.read_text().replace('driver = "mock"\npaced = false', 'driver = "aravis"')
    )
    ran = run("doctor", "--bench", bench, "--json", "-")
    assert ran.status == 1
    assert "Aravis" in ran.json["missing"]


def test_packages_that_are_not_installed_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("service.doctor.python.requires", lambda _: ["numpy>=2", "not-there>=1"])
    found = {finding.topic: finding for finding in look_at_python()}
    assert found["packages"].state == "missing"
    assert found["packages"].remedy.endswith("pip install not-there")


def interface(folder: Path, name: str, mtu: int, *, hardware: bool = True) -> None:
    (folder / name).mkdir(parents=True)
    (folder / name / "mtu").write_text(f"{mtu}\n")
    (folder / name / "type").write_text("1\n")
    if hardware:
        (folder / name / "device").mkdir()


def test_small_packets_and_buffers_are_advised_against(tmp_path: Path) -> None:
    interface(tmp_path / "net", "eth0", 1500)
    interface(tmp_path / "net", "eth1", 9000)
    interface(tmp_path / "net", "docker0", 1500, hardware=False)
    (tmp_path / "rmem_max").write_text("212992\n")
    found = look_at_network(tmp_path / "net", tmp_path / "rmem_max")
    assert [(each.topic, each.state) for each in found] == [
        ("network eth0", "advice"), ("network eth1", "ok"), ("socket buffer", "advice"),
    ]  # fmt: skip
    (tmp_path / "rmem_max").write_text("33554432\n")
    assert look_at_network(tmp_path / "net", tmp_path / "rmem_max")[-1].state == "ok"


def test_a_rule_for_usb_vision_is_found_by_what_it_says(tmp_path: Path) -> None:
    assert look_at_usb((tmp_path,))[0].state == "advice"
    (tmp_path / "70-other.rules").write_text('SUBSYSTEM=="usb", MODE="0666"')
    assert look_at_usb((tmp_path,))[0].state == "advice"
    rule = 'SUBSYSTEM=="usb", ENV{ID_USB_INTERFACES}=="*:ef0500:*", MODE="0666"'
    (tmp_path / "70-vision.rules").write_text(rule)
    assert look_at_usb((tmp_path,))[0].state == "ok"


def test_a_port_without_rights_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert look_at_serial(tmp_path)[0].state == "ok"
    (tmp_path / "ttyUSB0").touch()
    assert look_at_serial(tmp_path)[0].state == "ok"
    monkeypatch.setattr("os.access", lambda *_: False)
    closed = look_at_serial(tmp_path)[0]
    assert closed.state == "missing"
    assert "dialout" in closed.remedy


def test_a_home_that_cannot_be_written_is_missing(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    settings = Settings(home=tmp_path / "file" / "home")
    assert look_at_storage(settings, tmp_path)[1].state == "missing"
    assert is_writable(tmp_path / "not" / "yet" / "there")
