"""What the uncertainty of departures' parameters does to a set: it is made once more for each."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from calib.budget import BudgetRow
from calib.forward.model import Model
from calib.forward.parameter import from_table, parameters_of, to_table
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.coefficients.provenance import Provenance
from calib.radiometric.departures.corrected_statistics import Corrected, corrected_statistics
from calib.radiometric.departures.fitted_chain import carried
from calib.radiometric.estimation.choices import Choices
from calib.radiometric.estimation.from_statistics import determine
from calib.recording.block_statistics import RecordingStatistics
from calib.recording.header import RecordingHeader

_STDS = {
    "dark_offset_dn": "dark_offset_dn_std",
    "slope": "slope_std",
    "vignette": "vignette_std",
    "responsivity": "responsivity_std",
    "system_gain_dn_per_e": "system_gain_dn_per_e_std",
    "read_noise_e": "read_noise_e_std",
}


@dataclass(frozen=True)
class Case:
    """What a model is tried on."""

    statistics: RecordingStatistics
    header: RecordingHeader
    choices: Choices
    held_out_every: int

    def corrected(self, model: Model, start: Corrected | None = None) -> Corrected:
        """Return the statistics without the departures of `model`, found from `start` on."""
        return corrected_statistics(
            self.statistics,
            self.header,
            model,
            self.choices,
            held_out_every=self.held_out_every,
            start_dn=None if start is None else start.shift_dn,
        )


@dataclass(frozen=True)
class Shift:
    """What a set changes by where one parameter is off by its standard uncertainty."""

    effect: str
    parameter: str
    std: float
    unit: str
    change: dict[str, Any]


def shifts_of_parameters(
    case: Case, model: Model, start: Corrected, found: CoefficientSet, provenance: Provenance
) -> Iterator[Shift]:
    """Yield the change for each uncertain parameter, by calibrating once more."""
    choices = replace(case.choices, order=found.vignette_order)
    for name, stds in model.uncertainty.items():
        effect = next((e for e in carried(model.effects) if e.name == name), None)
        if effect is None:
            continue
        for parameter, std in stds.items():
            if std == 0:
                continue
            told = parameters_of(type(effect))[parameter]
            value = getattr(effect, parameter)
            step = std if value + std <= told.high else -std
            table = {**to_table(effect), parameter: value + step}
            other = model.with_effect(from_table(type(effect), table, name))
            moved = determine(
                case.corrected(other, start).statistics, case.header, provenance, choices
            ).coefficients
            change = {n: np.nan_to_num(getattr(moved, n) - getattr(found, n)) for n in _STDS}
            yield Shift(name, parameter, std, told.unit, change)


def widened(found: CoefficientSet, shifts: list[Shift]) -> CoefficientSet:
    """Return the set with the parameters' uncertainties in its own and in its budget.

    A parameter's error moves all columns at once: what it does to offset and slope goes together.
    """
    if not shifts:
        return found
    wider: dict[str, Any] = {}
    for name, std in _STDS.items():
        squares = [s.change[name] ** 2 for s in shifts]
        root = np.sqrt(getattr(found, std) ** 2 + np.sum(squares, axis=0))
        wider[std] = float(root) if np.ndim(root) == 0 else root
    together = [s.change["dark_offset_dn"] * s.change["slope"] for s in shifts]
    wider["offset_slope_covariance"] = found.offset_slope_covariance + np.sum(together, axis=0)
    rows = (*found.budget.rows, *(_row(found, s) for s in shifts))
    return replace(found, **wider, budget=replace(found.budget, rows=rows))


def _row(found: CoefficientSet, shift: Shift) -> BudgetRow:
    """Return the budget's row: the responsivity's relative change, of a typical column."""
    valid = found.valid
    relative = np.abs(shift.change["responsivity"][valid] / found.responsivity[valid])
    return BudgetRow(
        f"{shift.effect} {shift.parameter}", "B", "normal", shift.std, shift.unit,
        float(np.median(relative)) / shift.std, "common", "stated by the model file",
    )  # fmt: skip
