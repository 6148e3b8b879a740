"""What is hidden in a recording, and the light that a correction has to give back."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.concealed.generator.case import Case
from tests.concealed.generator.catalogue import RADIANCE
from tests.concealed.generator.chain import Chain, TakenBlock, scans
from tests.concealed.generator.mechanism import Mechanism
from tests.concealed.generator.scan import Happened, Memory, Scan, noted

_TEST_SAMPLES = 40

Arrays = dict[str, NDArray[Any]]


@dataclass(frozen=True)
class Answer:
    """The truth: `told` is plain JSON, `arrays` by name.

    Of each test image there are `<name>_radiance`, the source's true radiance at each column,
    `<name>_codes` as the sensor with all that is hidden takes it, in the middle of the recording,
    and `<name>_clean_codes` as it would take it with nothing hidden.
    """

    told: dict[str, Any]
    arrays: Arrays


def take_case(case: Case) -> tuple[list[TakenBlock], Answer]:
    """Return the recording's blocks and the answer."""
    sensor, plan = case.setting.sensor, case.setting.plan
    chain = Chain(case.mechanisms, {}, case.rng("noise"))
    middle = len(plan.blocks) // 2
    taken: list[TakenBlock] = []
    arrays, tests = _nominal(case), dict[str, Any]()
    for k, scan in enumerate(scans(sensor, plan)):
        taken.append(chain.block(scan))
        if k == middle:
            arrays, tests = _test_images(chain, scan, case, arrays)
    return taken, Answer(_told(case, case.mechanisms, tests), arrays)


def happened_in(case: Case) -> Happened:
    """Return what chance made of the recording, which is drawn once more for that."""
    memory = Memory()
    chain = Chain(case.mechanisms, memory, case.rng("noise"))
    for scan in scans(case.setting.sensor, case.setting.plan):
        chain.block(scan)
    return noted(memory)


def _told(case: Case, mechanisms: Sequence[Mechanism], tests: dict[str, Any]) -> dict[str, Any]:
    sensor, plan = case.setting.sensor, case.setting.plan
    effects = [
        {
            "name": one.name,
            "listed": hidden.listed,
            "shape": one.shape,
            "known_shape": hidden.known_shape,
            "rung": hidden.rung,
            "unit": one.unit,
            "touches_radiance": one.name in RADIANCE,
            "parameters": one.told(),
        }
        for hidden, one in zip(case.hidden, mechanisms, strict=True)
    ]
    return {
        "number": case.number,
        "kind": case.kind,
        "effects": effects,
        "sensor": {
            "system_gain_dn_per_e": sensor.gain_dn_per_e,
            "read_noise_e": sensor.read_noise_e,
            "full_well_e": sensor.full_well_e,
            "electrons_per_radiance_us": sensor.electrons_per_radiance_us,
        },
        "scale": {
            "duration_s": plan.duration_s,
            "line_period_us": plan.line_period_us,
            "top_signal_dn": case.setting.top_e * sensor.gain_dn_per_e,
        },
        "plan": {"order": plan.order, "darks": plan.darks, "temperature": plan.temperature},
        "test": tests,
    }


def _nominal(case: Case) -> Arrays:
    sensor = case.setting.sensor
    return {"relative_response": sensor.relative_response, "offset_dn": sensor.offset_dn}


def _test_images(
    chain: Chain, scan: Scan, case: Case, arrays: Arrays
) -> tuple[Arrays, dict[str, Any]]:
    """Return `arrays` with the test images added, and the conditions under which they are taken."""
    exposure_us = round(0.8 * scan.top_exposure_us, 1)
    columns = scan.sensor.columns
    edge = np.where(np.arange(columns) < columns // 3, 0.25, 1.0)
    added = dict(arrays)
    for name, image in (("flat", np.ones(columns)), ("edge", edge)):
        block = replace(
            scan.block, name=name, kind="scene", exposure_us=exposure_us,
            radiance=0.7 * scan.top_radiance, n_samples=_TEST_SAMPLES,
            started_s=scan.block.started_s + scan.n_samples * scan.line_period_us * 1e-6,
            image=tuple(image.tolist()),
        )  # fmt: skip
        aside = replace(scan, block=block, first_sample=scan.first_sample + scan.n_samples)
        rng, same = case.rng(f"test {name}"), case.rng(f"test {name}")
        taken = chain.aside(rng).block(aside)
        added[f"{name}_radiance"] = taken.source_radiance * image
        added[f"{name}_codes"] = taken.codes
        added[f"{name}_clean_codes"] = Chain((), {}, same).block(aside).codes
    told = {"exposure_us": exposure_us, "started_s": block.started_s,
            "temperature_c": block.temperature_c}  # fmt: skip
    return added, told
