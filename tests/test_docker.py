"""What can be read off the image and compose files without an engine: that they fit the program."""

import re
from pathlib import Path
from typing import Any

import pytest
import yaml

from service.bench.settings import BenchSettings
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


def test_the_image_runs_as_nobody_s_root_and_is_looked_after() -> None:
    users = re.findall(r"^USER (\S+)$", DOCKERFILE, re.M)
    assert users == ["1000"]
    assert "HEALTHCHECK" in DOCKERFILE
    assert "/healthz" in DOCKERFILE


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
    assert "healthcheck" in services["database"]
    assert set(compose("compose.hardware.yaml")) == set(services)


def test_hardware_has_the_ports_of_the_example_bench_and_the_host_s_network() -> None:
    bench = BenchSettings.load(ROOT / "examples" / "benches" / "hardware.toml")
    service = compose("compose.hardware.yaml")["service"]
    inside = {each.partition(":")[2] for each in ids(service, "devices")}
    assert inside == {part.port for _, part in bench._on_ports()}
    assert service["network_mode"] == "host"
    assert service["ports"] == []
    assert service["command"][service["command"].index("--host") + 1] == "127.0.0.1"
