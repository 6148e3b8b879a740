"""What can be read off the image and compose files without an engine: that they fit the program."""

import json
import os
import re
import subprocess
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml
from typer.testing import CliRunner

from service.bench.settings import BenchSettings
from service.cli.app import app
from service.settings import Settings

ROOT = Path(__file__).parents[1]
DOCKERFILE = (ROOT / "docker" / "Dockerfile").read_text("utf-8")


class Loader(yaml.SafeLoader):
    """Knows Compose's `!reset`, too."""


Loader.add_constructor("!reset", lambda loader, node: loader.construct_sequence(node))


def compose(name: str) -> dict[str, Any]:
    text = (ROOT / "docker" / name).read_text("utf-8")
    services: dict[str, Any] = yaml.load(text, Loader)["services"]  # noqa: S506  (a safe one)
    return services


def ids(service: dict[str, Any], key: str) -> list[str]:
    return [str(each) for each in service.get(key, [])]


def test_the_image_copies_what_is_there_and_uses_the_one_script() -> None:
    sources = [
        part for line in re.findall(r"^COPY (.*) \S+$", DOCKERFILE, re.M) for part in line.split()
    ]
    assert "docker/install-system.sh" in sources
    assert [each for each in sources if not (ROOT / each).exists()] == []
    ignored = (ROOT / ".dockerignore").read_text().split()
    assert not set(sources) & set(ignored)


def installed(folder: Path, *needs: str) -> list[str]:
    """Return what the script would install on a machine that has nothing, by a false apt-get."""
    folder.mkdir()
    asked = folder / "asked"
    for name, does in {
        "dpkg-query": "exit 1", "sudo": 'exec "$@"', "apt-get": f'echo "$@" >> {asked}',
    }.items():  # fmt: skip
        (folder / name).write_text(f"#!/bin/sh\n{does}\n")
        (folder / name).chmod(0o755)
    path = f"{folder}{os.pathsep}{os.environ['PATH']}"
    script = [ROOT / "docker" / "install-system.sh", *needs]
    subprocess.run(script, env={**os.environ, "PATH": path}, check=True)
    update, install = asked.read_text().splitlines()
    assert update.split()[0] == "update"
    return [each for each in install.split()[1:] if not each.startswith("-")]


def needs_named_in(text: str) -> list[str]:
    found = re.search(r"^(?:\t|RUN )docker/install-system\.sh ([a-z ]+)", text, re.M)
    assert found is not None
    return found[1].split()


def test_the_image_has_of_the_system_what_a_checkout_has_but_for_what_only_tests_need(
    tmp_path: Path,
) -> None:
    of_image = installed(tmp_path / "image", *needs_named_in(DOCKERFILE))
    of_checkout = installed(tmp_path / "checkout", *needs_named_in((ROOT / "Makefile").read_text()))
    assert "gir1.2-aravis-0.8" in of_image
    assert of_checkout[: len(of_image)] == of_image
    assert {"postgresql", "chromium"} <= set(of_checkout[len(of_image) :])
    assert len(set(of_checkout)) == len(of_checkout)


@pytest.mark.parametrize("needs", [(), ("servcie",)])
def test_the_script_installs_nothing_that_nobody_named(needs: tuple[str, ...]) -> None:
    script = [ROOT / "docker" / "install-system.sh", *needs]
    assert subprocess.run(script, check=False, capture_output=True).returncode == 2


def test_the_image_runs_as_nobody_s_root_and_is_looked_after() -> None:
    users = re.findall(r"^USER (\S+)$", DOCKERFILE, re.M)
    assert users == ["1000"]
    for name in ("compose.yaml", "compose.hardware.yaml"):
        assert all("user" not in service for service in compose(name).values())
    (checks,) = re.findall(r"^HEALTHCHECK .*\\\n +CMD (.*)$", DOCKERFILE, re.M)
    program, option, code = json.loads(checks)
    assert (program, option) == ("python3", "-c")
    compile(code, "the image's health check", "exec")
    assert "/healthz" in code


def in_exec_form(instruction: str) -> list[str]:
    (found,) = re.findall(rf"^{instruction} (\[.*\])$", DOCKERFILE, re.M)
    words: list[str] = json.loads(found)
    return words


def is_a_command(*words: str) -> bool:
    """Whether `darkflat` knows these commands and options; nothing is done."""
    return CliRunner().invoke(app, [*words, "--help"]).exit_code == 0


def test_what_containers_are_started_with_is_a_command_of_the_program() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert in_exec_form("ENTRYPOINT") == list(project["scripts"])
    assert not is_a_command("serve", "--hots", "0.0.0.0")  # noqa: S104
    assert is_a_command(*in_exec_form("CMD"))
    for name in ("compose.yaml", "compose.hardware.yaml"):
        assert is_a_command(*compose(name)["service"]["command"])
    for name in ("Dockerfile", "compose.yaml"):
        text = (ROOT / "docker" / name).read_text("utf-8")
        (named,) = re.findall(r"run --rm .*(key create .*)$", text, re.M)
        assert is_a_command(*named.split())


@pytest.mark.parametrize("name", ["compose.yaml", "compose.hardware.yaml"])
def test_nothing_is_published_but_to_this_machine(name: str) -> None:
    for service in compose(name).values():
        assert all(port.startswith("127.0.0.1:") for port in ids(service, "ports"))
        assert "privileged" not in service


@pytest.mark.parametrize("name", ["compose.yaml", "compose.hardware.yaml"])
def test_every_setting_is_one_that_the_service_reads(name: str) -> None:
    known = {f"DARKFLAT_{field}".upper() for field in Settings.model_fields}
    environment = compose(name)["service"]["environment"]
    assert {each for each in environment if each.startswith("DARKFLAT_")} <= known


def test_the_service_waits_for_a_database_that_is_well() -> None:
    services = compose("compose.yaml")
    assert services["service"]["depends_on"]["database"]["condition"] == "service_healthy"
    assert services["database"]["healthcheck"]["test"][:2] == ["CMD", "pg_isready"]
    assert services["service"]["build"] == {"context": "..", "dockerfile": "docker/Dockerfile"}
    assert set(compose("compose.hardware.yaml")) == set(services)


def test_hardware_has_the_ports_of_the_example_bench_and_the_host_s_network() -> None:
    bench = BenchSettings.load(ROOT / "examples" / "benches" / "hardware.toml")
    service = compose("compose.hardware.yaml")["service"]
    inside = {each.partition(":")[2] for each in ids(service, "devices")}
    assert inside == {part.port for _, part in bench._on_ports()}
    assert service["network_mode"] == "host"
    assert service["ports"] == []
    assert "/dev/bus/usb:/dev/bus/usb" in ids(service, "volumes")
    assert ids(service, "device_cgroup_rules") == ["c 189:* rmw"]  # 189: USB, whatever its number
    assert service["command"][service["command"].index("--host") + 1] == "127.0.0.1"
