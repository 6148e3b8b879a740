"""`diagnose` of several recordings, and of such as cannot be diagnosed."""

from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from calib.forward.effects.exposure_offset import ExposureOffset
from calib.forward.model import Model
from service.cli.simulated_recording import simulate_recording
from service.plan.model import Plan
from tests.calib.diagnosis.recordings import plain_model
from tests.service.cli.answers import Ran

Run = Callable[..., Ran]


def record(
    folder: Path, name: str, rows: Sequence[tuple[float, int]], *, lines: int = 60,
    model: Model | None = None,
) -> Path:  # fmt: skip
    """Simulate blocks of exposure, us, and level, 0 for a dark; return the recording."""
    blocks = [
        {"kind": "flat" if level else "dark", "exposure_us": t, "level": level or 1}
        for t, level in rows
    ]
    plan = Plan.parse(
        {
            "lines": lines, "sweep": {"type": "listed", "blocks": blocks},
            "camera": {"line_period_us": 1400.0, "pixel_format": "Mono12"},
            "source": {"lamps": 4, "radiance": {"1": 1.0, "2": 2.05}},
        }
    )  # fmt: skip
    out = folder / name
    simulate_recording(
        plain_model(32) if model is None else model, plan, out, seed=3, scenes_folder=folder
    )
    return out


@pytest.mark.parametrize(
    ("rows", "lines", "told"),
    [
        ([(500.0, 1), (500.0, 1)], 60, ("one-signal", "add flats at another exposure")),
        ([(500.0, 0), (200.0, 0)], 60, ("no-flats", "add flats at two exposures")),
        ([(1390.0, 4), (1300.0, 4)], 60, ("saturated", "at two exposures below 1300 us")),
        ([(200.0, 0), (200.0, 1), (900.0, 1)], 2, ("too-few-lines", "record blocks of 4 lines")),
    ],
    ids=["one exposure and no darks", "darks alone", "saturated", "two lines per block"],
)
def test_what_cannot_be_diagnosed_says_so_and_which_blocks_to_add(
    run: Run,
    tmp_path: Path,
    rows: list[tuple[float, int]],
    lines: int,
    told: tuple[str, str],
) -> None:
    code, words = told
    text = plain_model(32).dumps()
    assert "electrons_per_radiance_us = 10.0" in text
    bright = Model.loads(text.replace("radiance_us = 10.0", "radiance_us = 30.0"))
    bright = bright.without("full_well")
    recording = record(tmp_path, "rec.h5", rows, lines=lines, model=bright)
    ran = run("diagnose", recording, "--json", "-")
    assert (ran.status, ran.error_code) == (1, code), ran.stderr
    sentences = [line for line in ran.stderr.strip().splitlines() if line.startswith("darkflat:")]
    assert len(sentences) == 1
    assert words in sentences[0]
    assert "rec.h5" in sentences[0]


def test_an_ambiguous_recording_asks_for_what_makes_it_clear(run: Run, tmp_path: Path) -> None:
    rows = [(t, 1) for t in (200.0, 400.0, 600.0, 800.0, 1000.0)] + [(200.0, n) for n in (2, 3, 4)]
    late = plain_model(48).with_effect(ExposureOffset(-1.5))
    first = record(tmp_path, "first.h5", rows, lines=120, model=late)
    asked = run("diagnose", first, "--json", "-")
    assert asked.status == 0, asked.stderr
    assert asked.json["verdict"] == "ambiguous"
    following = asked.json["next_measurement"]
    assert following["expected_sigma"] > 2.0 * following["recorded_sigma"]
    assert Plan.loads(following["plan_toml"]) == Plan.parse(following["plan"])
    # Both are made within a second or so, and last longer: one camera makes no two at once.
    overlap = run("diagnose", first, first, "--json", "-")
    assert (overlap.status, overlap.error_code) == (1, "recordings-overlap")


def test_a_model_of_another_size_is_one_sentence(run: Run, recording_file: Path) -> None:
    ran = run("diagnose", recording_file, "--model", "demo", "--json", "-")
    assert (ran.status, ran.error_code) == (1, "model-mismatch")
    assert "columns is 1024 in it and 256 in the recording" in ran.stderr
