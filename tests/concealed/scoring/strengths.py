"""Fitted parameters against what was hidden, where both mean the same number.

Left out are strengths that both sides define about a reference of their own (drifts, temperatures,
events of random size), and shapes that the catalogue has no such parameter for.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.concealed.scoring.outcome import Outcome

Told = Mapping[str, Any]
"""One hidden effect as its answer tells it."""


@dataclass(frozen=True)
class Comparison:
    """What a finding's parameter is held against.

    Attributes:
        parameter: Its name in the finding.
        shapes: Of the hidden effect, for which the two mean the same.
        true: The parameter's true value, from the effect and the whole answer.
    """

    parameter: str
    shapes: tuple[str, ...]
    true: Callable[[Told, Told], float]


def _strength(effect: Told, answer: Told) -> float:
    return float(effect["parameters"]["strength"])


def _signed(effect: Told, answer: Told) -> float:
    return float(effect["parameters"]["sign"]) * _strength(effect, answer)


def _per_dn(effect: Told, answer: Told) -> float:
    return _signed(effect, answer) / float(answer["scale"]["top_signal_dn"])


def _mean_rate(effect: Told, answer: Told) -> float:
    return _strength(effect, answer) * float(np.mean(effect["parameters"]["relative"]))


def _of_sent(effect: Told, answer: Told) -> float:
    """Return the share of the lines sent that are repeats, where each line read may have one."""
    return _strength(effect, answer) / (1.0 + _strength(effect, answer))


COMPARED: dict[str, Comparison] = {
    "interpixel_capacitance": Comparison("column_coupling", ("nearest",), _strength),
    "lag": Comparison("share", ("each_electron", "incomplete_reset"), _strength),
    "brighter_fatter": Comparison("row_per_e", ("plain",), _strength),
    "nonlinearity": Comparison("beta_per_dn", ("quadratic",), _per_dn),
    "reciprocity_failure": Comparison("exponent", ("power",), _signed),
    "exposure_offset": Comparison("offset_us", ("plain",), _signed),
    "exposure_jitter": Comparison("relative_std", ("gaussian",), _strength),
    "offset_temperature": Comparison("dn_per_k", ("linear",), _signed),
    "line_noise": Comparison("std_dn", ("gaussian",), _strength),
    "banding": Comparison("amplitude_dn", ("sine",), _strength),
    "lamp_flicker": Comparison("amplitude", ("sine",), _strength),
    "dark_current": Comparison("electrons_per_us", ("gaussian",), _mean_rate),
    "tap_crosstalk": Comparison("fraction", ("mutual",), _strength),
    "duplicated_lines": Comparison("probability", ("whole",), _of_sent),
}


def strength_z(every: Iterable[Outcome]) -> list[tuple[str, float]]:
    """Return the error of each comparable parameter over its stated standard uncertainty."""
    return [pair for one in every for pair in _of_case(one)]


def _of_case(one: Outcome) -> list[tuple[str, float]]:
    if one.answer is None:
        return []
    told = {effect["name"]: effect for effect in one.answer.told["effects"]}
    found = []
    for finding, parameters in zip(one.findings, one.parameters, strict=True):
        compared = COMPARED.get(finding.name)
        effect = told.get(finding.name)
        if compared is None or effect is None or effect["shape"] not in compared.shapes:
            continue
        stated = parameters.get(compared.parameter)
        if stated is None or not stated["std"] or not np.isfinite(stated["std"]):
            continue
        error = float(stated["value"]) - compared.true(effect, one.answer.told)
        found.append((finding.name, error / float(stated["std"])))
    return found
