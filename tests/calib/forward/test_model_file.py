"""Model files say what is wrong with them in one sentence."""

from collections.abc import Callable
from pathlib import Path

import pytest

from calib.errors import InputError
from calib.forward.effects.lamp_drift import LampDrift
from calib.forward.model import Model
from calib.forward.model_file import preset_names

GOOD = """
[camera]
columns = 8
bit_depth = 12
[effects.responsivity]
[effects.system_gain]
[effects.adc]
"""

BAD = {
    "not TOML": ("[camera", "not-toml", "not TOML"),
    "unknown table": (GOOD + "[lens]\n", "unknown-key", "'lens'.*camera, source, effects"),
    "unknown camera key": (
        GOOD.replace("columns", "colums"),
        "unknown-key",
        r"\[camera\]: unknown key 'colums'",
    ),
    "unknown effect": (GOOD + "[effects.vignete]\n", "unknown-effect", "vignete.*vignette"),
    "unknown parameter": (
        GOOD + "[effects.read_noise]\nstd = 1\n",
        "unknown-key",
        r"\[effects.read_noise\]: unknown key 'std'; allowed: std_e",
    ),
    "out of bounds": (
        GOOD + "[effects.read_noise]\nstd_e = -1\n",
        "parameter-out-of-bounds",
        "read_noise: std_e is -1",
    ),
    "not a number": (GOOD + "[effects.read_noise]\nstd_e = 'x'\n", "wrong-type", "std_e is 'x'"),
    "a boolean number": (GOOD + "[effects.read_noise]\nstd_e = true\n", "wrong-type", "True"),
    "nan": (GOOD + "[effects.read_noise]\nstd_e = nan\n", "parameter-out-of-bounds", "nan"),
    "not a list": (GOOD + "[effects.vignette]\ncoefficients = 1\n", "wrong-type", "coefficients"),
    "no adc": (GOOD.replace("[effects.adc]", ""), "effect-missing", "adc is missing"),
    "two bit depths": (
        GOOD.replace("[effects.adc]", "[effects.adc]\nbit_depth = 8"),
        "bit-depth-mismatch",
        "8.*12",
    ),
    "bad bit depth": (GOOD.replace("= 12", "= 7"), "bad-header", r"\[camera\] bit_depth"),
    "quadrants of a line": (
        GOOD.replace("columns", 'tap_layout = "quadrants"\ncolumns')
        + '[effects.offset]\ntap_offset_dn = [1, 2, 3, 4]\ntap_layout = "quadrants"\n',
        "unknown-tap-layout",
        "not one of a line sensor",
    ),
    "an axis's row of a line": (
        GOOD + "[effects.vignette]\naxis_row = 3\n",
        "area-sensor",
        "axis_row is 3.* no rows",
    ),
    "PRNU of one row of a frame": (
        GOOD.replace("columns", "rows = 4\ncolumns").replace(
            "[effects.responsivity]", "[effects.responsivity]\nprnu = [1, 1, 1, 1, 1, 1, 1, 1]"
        ),
        "wrong-length",
        "8 values; give 32",
    ),
    "more pixels than fit": (
        GOOD.replace("columns = 8", "rows = 1000000\ncolumns = 1000000"),
        "too-many-pixels",
        "1000000 rows of 1000000 columns",
    ),
    "PRNU too short": (
        GOOD.replace("[effects.responsivity]", "[effects.responsivity]\nprnu = [1, 1]"),
        "wrong-length",
        "2 values; give 8",
    ),
    "taps that the camera lacks": (
        GOOD + '[effects.offset]\ntap_offset_dn = [1, 2]\ntap_layout = "halves"\n',
        "tap-layout-mismatch",
        "'halves'.*'single'",
    ),
    "unknown tap layout": (
        GOOD + '[effects.offset]\ntap_layout = "eighths"\n',
        "parameter-out-of-bounds",
        "eighths.*odd_even",
    ),
    "a dark lens": (
        GOOD + "[effects.vignette]\ncoefficients = [-1.5]\n",
        "vignette-not-positive",
        "above 0",
    ),
}


@pytest.mark.parametrize(("text", "code", "message"), BAD.values(), ids=BAD)
def test_a_bad_model_file_is_refused_in_one_sentence(text: str, code: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        Model.loads(text)
    assert caught.value.code == code
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", preset_names())
def test_a_preset_survives_saving_and_loading(name: str, tmp_path: Path) -> None:
    model = Model.preset(name)
    model.save(tmp_path / "model.toml")
    assert Model.load(tmp_path / "model.toml") == model
    assert [entry.name for entry in tmp_path.iterdir()] == ["model.toml"]


def test_an_unknown_preset_is_named_with_the_known_ones() -> None:
    with pytest.raises(InputError, match="agcam-nir, agcam-red, demo, modern-12bit"):
        Model.preset("agcam-blue")


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        Model.load(tmp_path / "none.toml")


def test_effects_are_put_in_physical_order_replaced_and_removed() -> None:
    model = Model.preset("demo")
    drifting = model.with_effect(LampDrift(amplitude=0.1))
    names = [effect.name for effect in drifting.effects]
    assert names.index("lamp_drift") == names.index("illumination") + 1
    assert drifting.with_effect(LampDrift(amplitude=0.2)).effect("lamp_drift") == LampDrift(
        amplitude=0.2
    )
    assert drifting.without("lamp_drift") == model
    assert model.effect("lamp_drift") is None
    with pytest.raises(InputError, match="adc is missing"):
        model.without("adc")


@pytest.mark.parametrize("make", [Path.mkdir, Path.touch], ids=["folder", "file"])
def test_a_preset_is_found_beside_a_path_of_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, make: Callable[[Path], None]
) -> None:
    make(tmp_path / "demo")
    monkeypatch.chdir(tmp_path)
    assert Model.named("demo") == Model.preset("demo")


@pytest.mark.parametrize("name", ["mine.toml", "./mine.toml", "./demo"])
def test_an_ending_or_a_folder_names_a_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path(name).write_text(GOOD)
    assert Model.named(name) == Model.loads(GOOD)


def test_a_name_that_is_no_preset_says_how_to_name_a_file() -> None:
    with pytest.raises(InputError, match="named with its folder") as caught:
        Model.named("mine")
    assert caught.value.code == "unknown-preset"
