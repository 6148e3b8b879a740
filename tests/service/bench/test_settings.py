from pathlib import Path

import pytest

from calib.errors import InputError
from service.bench import BenchSettings

EXAMPLES = Path(__file__).parents[3] / "examples" / "benches"
MOCKS = {"camera": {"driver": "mock"}, "light": {"driver": "mock"}, "simulation": {}}

WRONG = {
    "unknown driver": (
        {**MOCKS, "camera": {"driver": "arvis"}},
        "camera.driver = 'arvis' is unknown; allowed are 'aravis', 'mock'",
    ),
    "no driver": ({**MOCKS, "light": {"port": "x"}}, "light.driver is missing; allowed are 'gen'"),
    "typo": (
        {**MOCKS, "light": {"driver": "gen", "prot": "/dev/ttyUSB0"}},
        "light.prot is an unknown key; did you mean port?",
    ),
    "unknown table": ({**MOCKS, "lamps": {}}, "lamps is an unknown key"),
    "mocks without a simulation": (
        {"camera": {"driver": "mock"}, "light": {"driver": "mock"}},
        "mock devices need a [simulation]",
    ),
    "no address": (
        {"camera": {"driver": "aravis"}, "light": {"driver": "gen", "port": "x"}},
        "camera.address is missing",
    ),
    "no port": (
        {"camera": {"driver": "aravis", "address": "x"}, "light": {"driver": "gen"}},
        "light.port is missing",
    ),
    "no supplies": (
        {"camera": {"driver": "aravis", "address": "x"}, "light": {"driver": "gen", "port": "x"}},
        "light.addresses is missing",
    ),
    "an id that is a path": ({**MOCKS, "id": "../x"}, "id = '../x'"),
    "a supply that cannot be": (
        {**MOCKS, "light": {"driver": "gen", "addresses": [31]}},
        "light.addresses[0] = 31",
    ),
}


@pytest.mark.parametrize(("content", "said"), WRONG.values(), ids=WRONG)
def test_a_wrong_bench_file_is_one_sentence(content, said):
    with pytest.raises(InputError) as caught:
        BenchSettings.parse(content, where="bench.toml")
    assert str(caught.value).startswith("bench.toml: ")
    assert said in str(caught.value)
    assert caught.value.code == "bench-invalid"


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda path: path.stem)
def test_every_example_is_a_bench(path):
    assert BenchSettings.load(path).id == path.stem


def test_the_simulated_bench_stands_on_real_protocols():
    settings = BenchSettings.load(EXAMPLES / "simulated.toml")
    assert settings.needs_simulated_camera
    assert settings.needs_emulators


def test_hardware_needs_nothing_simulated():
    settings = BenchSettings.load(EXAMPLES / "hardware.toml")
    assert settings.simulation is None
    assert not settings.needs_emulators


def test_paths_are_taken_from_the_bench_file(tmp_path: Path):
    content = {**MOCKS, "simulation": {"model": "mine.toml", "world": "world"}}
    settings = BenchSettings.parse(content).beside(tmp_path)
    assert settings.simulation is not None
    assert settings.simulation.model == str(tmp_path / "mine.toml")
    assert settings.simulation.world == tmp_path / "world"
