"""The plugin gives other people's suites a mocked bench, and costs the others nothing."""

import subprocess
import sys

import pytest

pytest_plugins = ["pytester"]

_SUITE = """
from drivers.ports import CameraSettings

def test_lamps_show_in_the_picture(darkflat_bench):
    camera = darkflat_bench.camera
    camera.configure(CameraSettings(
        exposure_us=50.0, line_period_us=100.0, frame_lines=16,
        n_columns=darkflat_bench.model.camera.columns))
    dark, = camera.frames(1)
    darkflat_bench.light.set_level(3)
    lit, = camera.frames(1)
    darkflat_bench.shutter.set_capped(True)
    capped, = camera.frames(1)
    assert lit.dn.mean() > dark.dn.mean() + 100 > capped.dn.mean() + 50
    assert darkflat_bench.monitor.read().current_a > 0

def test_next_bench_is_dark_and_uncapped_again(darkflat_bench):
    assert darkflat_bench.light.state().level == 0
    assert not darkflat_bench.world.state().capped
"""


def test_fixture_works_in_another_suite(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(_SUITE)
    pytester.runpytest_inprocess("-p", "no:cacheprovider").assert_outcomes(passed=2)


def test_loading_the_plugin_imports_nothing_heavy() -> None:
    code = (
        "import sys, drivers.mock.pytest_plugin;"
        "print([m for m in ('numpy', 'numba', 'serial', 'h5py') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
