from pathlib import Path

import pytest

from service.plan.describe import describe
from service.plan.model import Plan

PLANS = sorted((Path(__file__).parents[3] / "examples" / "plans").glob("*.toml"))


@pytest.mark.parametrize("path", PLANS, ids=lambda path: path.stem)
def test_every_example_is_a_plan_that_can_be_described(path: Path):
    assert "blocks" in describe(Plan.load(path), columns=768)


def test_there_are_examples():
    assert {path.stem for path in PLANS} >= {"exposure-sweep", "level-sweep", "factorial"}
