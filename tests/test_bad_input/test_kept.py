"""What is not known is kept and reported; what is wrongly typed is status 2."""

import tomllib
from pathlib import Path

import pytest

from calib.recording.open import open_recording
from service.cli.app import app
from tests.test_bad_input.case import Case
from tests.test_bad_input.damage import replaced, scene_named, several
from tests.test_bad_input.running import run

CSV, TOML = "rec/conditions.csv", "rec/recording.toml"


def test_unknown_keys_and_columns_are_kept_and_reported(sound: Path, tmp_path: Path) -> None:
    damage = several(
        replaced(TOML, "[camera]\n", '[camera]\noperator = "Ada"\n'),
        replaced(TOML, "[source]\n", "[source]\nhours = 12\n"),
        lambda folder: (folder / CSV).write_text(
            "".join(
                f"{line},{'humidity' if not number else 41}\n"
                for number, line in enumerate((folder / CSV).read_text().splitlines())
            )
        ),
    )
    case = Case("unknown keys", "import rec --out out.h5", "", (), "", damage)
    ran = run(case, sound, tmp_path)
    assert (ran.status, ran.stderr) == (0, "")
    for name in ("camera.operator", "source.hours", "humidity"):
        assert name in ran.stdout
    header = open_recording(tmp_path / "work/out.h5").header
    assert header.camera.model_extra == {"operator": "Ada"}
    assert header.source.model_extra is not None
    assert header.source.model_extra["hours"] == 12
    assert all(block.model_extra == {"humidity": 41} for block in header.blocks)


def test_an_exported_folder_keeps_them_too(sound: Path, tmp_path: Path) -> None:
    damage = replaced(TOML, "[camera]\n", '[camera]\noperator = "Ada"\n')
    ran = run(Case("x", "export rec --out out", "", (), "", damage), sound, tmp_path)
    assert ran.status == 0
    content = tomllib.loads((tmp_path / "work/out/recording.toml").read_text())
    assert content["camera"]["operator"] == "Ada"


@pytest.mark.parametrize(
    "command",
    [
        "nonsense",
        "import",
        "import rec",
        "import rec rec --out out.h5",
        "import rec --out out.h5 --fast",
        "export rec.h5 --out out --format png",
        "calibrate rec --out out.h5 --order many",
        "calibrate rec --out out.h5 --order 99",
        "apply set.h5 --out out.h5",
        "apply set.h5 rec --out out.h5 --at yesterday",
        "apply set.h5 rec --out out.h5 --exposure-us -1",
        "apply set.h5 rec --out out.h5 --transmittance 0.9",
        "simulate demo plan.toml --out out.h5 --seed -1",
        "sweep plan.toml",
        "store certify 0123",
        "store list --state perfect",
        "store lookup --serial D0001 --bit-depth 99",
    ],
)
def test_wrong_usage_is_status_2_and_touches_nothing(
    sound: Path, tmp_path: Path, command: str
) -> None:
    ran = run(Case("wrong usage", command, "", (), ""), sound, tmp_path)
    assert ran.status == 2
    assert "Usage: " in ran.stderr
    assert ran.stdout == ""
    assert ran.after == ran.before


def test_a_scene_of_the_wrong_shape_is_named(sound: Path, tmp_path: Path) -> None:
    import numpy as np

    def damage(folder: Path) -> None:
        scene_named(CSV, "field")(folder)
        (folder / "rec/scenes").mkdir()
        np.save(folder / "rec/scenes/field.npy", np.ones((4, 63)))

    ran = run(Case("x", "import rec --out out.h5", "", (), "", damage), sound, tmp_path)
    assert (ran.status, ran.error["code"]) == (1, "scene-invalid")
    assert ran.after == ran.before


def test_the_application_is_the_one_that_is_installed() -> None:
    assert app.info.name == "darkflat"
