import json
from pathlib import Path

import pytest

from calib.errors import InputError
from service.plan.model import Plan
from tests.service.plan.plans import content, factorial, plan

TYPOS = {
    "key of the plan": ({"ordre": "reversed"}, ["ordre is an unknown key", "did you mean order?"]),
    "key of a part": (
        {"camera": {"line_perod_us": 1000.0}},
        ["camera.line_perod_us is an unknown key", "did you mean line_period_us?"],
    ),
    "key of a sweep": (
        {"sweep": {"type": "exposure", "exposure_us": [1.0], "level": 1}},
        ["sweep.exposure_us is an unknown key", "exposures_us", "level"],
    ),
    "key of a listed block": (
        {"sweep": {"type": "listed", "blocks": [{"exposur_us": 1.0}]}},
        ["sweep.blocks[0].exposur_us is an unknown key", "did you mean exposure_us?"],
    ),
    "kind of sweep": (
        {"sweep": {"type": "exposures"}},
        ["sweep.type = 'exposures' is unknown", "'exposure', 'level', 'factorial', 'listed'"],
    ),
    "no kind of sweep": ({"sweep": {"level": 1}}, ["sweep.type is missing", "'factorial'"]),
    "order": ({"order": "revrsed"}, ["order.type = 'revrsed'", "'as_given', 'reversed'"]),
    "random without a seed": ({"order": "random"}, ["order.seed is missing"]),
    "darks": ({"darks": "befor"}, ["darks.placement = 'befor'", "'before'"]),
    "saturation": ({"saturation": {"action": "halt"}}, ["saturation.action = 'halt'", "'skip'"]),
    "lamp mode of a level": (
        {"lamps": {"per_level": {"2": "of"}}},
        ["lamps.per_level.2 = 'of'", "'off_between_blocks'"],
    ),
}

NONSENSE = {
    "no lines": ({"lines": 0}, "lines = 0"),
    "lines are NaN": ({"lines": float("nan")}, "lines = nan"),
    "a period of ages": ({"camera": {"line_period_us": 9e307}}, "line_period_us is beyond"),
    "a part is no table": ({"camera": 7}, "camera = 7: should be a table"),
    "no exposures": (
        {"sweep": {"type": "exposure", "exposures_us": [], "level": 1}},
        "sweep.exposures_us",
    ),
    "negative exposure": (
        {"sweep": {"type": "exposure", "exposures_us": [-1.0], "level": 1}},
        "sweep.exposures_us[0] = -1.0",
    ),
    "infinite level": (
        {"sweep": {"type": "exposure", "exposures_us": [1.0], "level": float("inf")}},
        "sweep.level = inf",
    ),
    "NaN radiance": ({"source": {"radiance": {"1": float("nan")}}}, "source.radiance.1 = nan"),
    "negative radiance": ({"source": {"radiance": {"1": -3.0}}}, "source.radiance.1 = -3.0"),
    "percent where a share is meant": (
        {"source": {"certificate_relative_std": 1.5}},
        "source.certificate_relative_std = 1.5",
    ),
    "negative uncertainty": (
        {"source": {"monitor_relative_std": -0.01}},
        "source.monitor_relative_std = -0.01",
    ),
    "a level that TOML splits at its point": (
        {"source": {"radiance": {"0": {"25": 3.0}}}},
        'source.radiance: a level with a point needs quotes in TOML: "0.25"',
    ),
    "a level is no number": ({"source": {"radiance": {"one": 1.0}}}, "source.radiance.one"),
    "frames do not fill the block": ({"frame_lines": 7}, "frame_lines = 7 does not divide 64"),
    "exposure beyond the line period": (
        {"camera": {"line_period_us": 250.0}},
        "an exposure of 300 µs is longer than camera.line_period_us = 250",
    ),
    "more lamps than there are": (
        {"sweep": factorial(levels=3), "source": {"lamps": 2}},
        "level 3 needs more than source.lamps = 2",
    ),
    "can never settle": ({"settle": {"timeout_s": 1.0, "stable_for_s": 2.0}}, "settle: timeout_s"),
    "limits the wrong way round": (
        {"interlocks": {"camera_temperature_c": [40.0, 10.0]}},
        "camera_temperature_c must be [lowest, highest]",
    ),
}


@pytest.mark.parametrize(("changes", "said"), TYPOS.values(), ids=TYPOS)
def test_a_typo_is_one_sentence_that_names_the_key_and_what_is_allowed(changes, said):
    with pytest.raises(InputError) as caught:
        Plan.parse(content(**changes), where="plan.toml")
    sentence = str(caught.value)
    assert sentence.startswith("plan.toml: ")
    assert "\n" not in sentence
    for part in said:
        assert part in sentence
    assert caught.value.code == "plan-invalid"


@pytest.mark.parametrize(("changes", "said"), NONSENSE.values(), ids=NONSENSE)
def test_what_cannot_be_measured_is_refused(changes, said):
    with pytest.raises(InputError, match="the plan: ") as caught:
        plan(**changes)
    assert said in str(caught.value)


def test_a_plan_read_back_is_the_same_plan():
    given = plan(
        sweep=factorial(),
        order={"type": "random", "seed": 4},
        darks={"placement": "after", "per_exposure": 2},
        source={"radiance": {"1": 10.5, "2": 20.0}, "identity": "sphere 7"},
        lamps={"per_level": {"2": "off_between_blocks"}},
    )
    again = Plan.loads(given.dumps())
    assert again == given
    assert again.digest() == given.digest()


def test_toml_and_json_say_the_same(tmp_path: Path):
    given = plan(order="reversed")
    toml, json_file = tmp_path / "plan.toml", tmp_path / "plan.json"
    toml.write_text(given.dumps(), encoding="utf-8")
    json_file.write_text(json.dumps(given.model_dump(mode="json")), encoding="utf-8")
    assert Plan.load(toml) == Plan.load(json_file) == given


def test_another_plan_has_another_digest():
    assert plan(lines=32).digest() != plan(lines=64).digest()


def test_a_file_that_is_no_toml_is_refused_by_its_name(tmp_path: Path):
    path = tmp_path / "torn.toml"
    path.write_text("lines = ", encoding="utf-8")
    with pytest.raises(InputError, match=r"torn\.toml is not valid TOML"):
        Plan.load(path)
    with pytest.raises(InputError, match=r"none\.toml cannot be read"):
        Plan.load(tmp_path / "none.toml")


FRAMES = {
    "a short block is one frame": (64, 64),
    "a long one is cut into its longest divisor up to 512": (714, 357),
    "a prime number of lines is one frame": (1021, 1021),
    "a power of two": (4096, 512),
}


@pytest.mark.parametrize(("lines", "wanted"), FRAMES.values(), ids=FRAMES)
def test_frames_fill_the_block(lines, wanted):
    assert plan(lines=lines).lines_per_frame == wanted
