"""What a plan states of its source is what a calibration's budget counts."""

from dataclasses import asdict, fields

import pytest

from calib.forward.model import Model
from calib.radiometric.estimation.source_uncertainty import SourceUncertainty
from service.cli.demo_plan import demo_plan
from service.plan.expand import planned_header
from service.plan.source import PlanSource
from tests.service.plan.plans import plan

STATED = {
    "certificate_relative_std": 0.011,
    "level_relative_std": 0.003,
    "nonuniformity_relative": 0.02,
    "monitor_relative_std": 0.004,
    "standard": "lamp F-7",
    "certificate": "C-17",
}


def test_every_uncertainty_of_the_source_can_be_planned():
    computed = {"spectral_response_relative_std"}
    assert set(STATED) == {field.name for field in fields(SourceUncertainty)} - computed
    assert set(STATED) <= set(PlanSource.model_fields)


@pytest.mark.parametrize("name", STATED)
def test_what_the_plan_states_stands_in_the_header(name):
    header = planned_header(plan(source={name: STATED[name]}), columns=64)
    expected = asdict(SourceUncertainty()) | {name: STATED[name]}
    assert asdict(SourceUncertainty.of_header(header.source)) == expected


def test_nothing_of_the_source_is_unknown_to_a_recording():
    header = planned_header(plan(source={"identity": "sphere 7", **STATED}), columns=64)
    assert header.source.identity == "sphere 7"
    assert header.source.model_extra == {}


def test_the_demonstration_states_its_source():
    header = planned_header(demo_plan(Model.preset("demo"), lamps=4), columns=64)
    stated = asdict(SourceUncertainty.of_header(header.source))
    assert all(stated[name] for name in STATED)
