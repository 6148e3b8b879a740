"""A calibration without the departures of a model, and what their parameters leave unsure."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from calib.budget import BudgetRow
from calib.forward.departure import Departure
from calib.forward.effects.system_gain import SystemGain
from calib.forward.effects.vignette import Vignette
from calib.forward.model import Model
from calib.forward.parameter import from_table, parameters_of, to_table
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.coefficients.departures import Departures
from calib.radiometric.coefficients.provenance import Provenance
from calib.radiometric.departures.corrected_statistics import Corrected, corrected_statistics
from calib.radiometric.departures.fitted_chain import carried
from calib.radiometric.departures.model_check import check_model, model_findings
from calib.radiometric.estimation.choices import Choices
from calib.radiometric.estimation.from_statistics import Determined, determine
from calib.recording.block_statistics import RecordingStatistics
from calib.recording.header import RecordingHeader

GAIN_SIGMA = 5.0
"""A system gain that is off by so many of its standard uncertainties is not by chance."""
_STDS = {
    "dark_offset_dn": "dark_offset_dn_std",
    "slope": "slope_std",
    "vignette": "vignette_std",
    "responsivity": "responsivity_std",
    "system_gain_dn_per_e": "system_gain_dn_per_e_std",
    "read_noise_e": "read_noise_e_std",
}


@dataclass(frozen=True)
class Amended:
    """The calibration and the statistics that it was made from."""

    determined: Determined
    statistics: RecordingStatistics


@dataclass(frozen=True)
class _Case:
    """What a model is tried on."""

    statistics: RecordingStatistics
    header: RecordingHeader
    choices: Choices
    held_out_every: int

    def corrected(self, model: Model, start: Corrected | None = None) -> Corrected:
        return corrected_statistics(
            self.statistics,
            self.header,
            model,
            self.choices,
            held_out_every=self.held_out_every,
            start_dn=None if start is None else start.shift_dn,
        )


def amended(
    statistics: RecordingStatistics,
    header: RecordingHeader,
    provenance: Provenance,
    choices: Choices,
    model: Model,
    *,
    held_out_every: int,
) -> Amended:
    """Determine a set from statistics without what the model's departures add.

    Raises:
        InputError, NotDeterminedError: As `determine`; `model-mismatch`, `model-unit`,
            `relative-with-model`, `line-period-missing`.
    """
    findings = tuple(model_findings(model))
    check_model(model, header, relative=choices.relative)
    if not carried(model.effects):
        plain = determine(statistics, header, provenance, choices)
        return Amended(replace(plain, warnings=(*findings, *plain.warnings)), statistics)
    case = _Case(statistics, header, choices, held_out_every)
    corrected = case.corrected(model)
    found = determine(corrected.statistics, header, provenance, choices)
    shifts = list(_shifts_of_parameters(case, model, corrected, found.coefficients, provenance))
    coefficients = _widened(found.coefficients, shifts)
    carrying = replace(coefficients, departures=_departures(model, statistics, header))
    warnings = (*findings, *_gain_findings(model, coefficients), *found.warnings)
    return Amended(replace(found, coefficients=carrying, warnings=warnings), corrected.statistics)


def _gain_findings(model: Model, found: CoefficientSet) -> Iterator[str]:
    """Yield a sentence where the model's system gain is not the recording's."""
    gain = model.truth().system_gain_dn_per_e
    std = found.system_gain_dn_per_e_std
    if abs(gain - found.system_gain_dn_per_e) > GAIN_SIGMA * std:
        yield (
            f"The model's system gain is {gain:.4g} DN/e-, that of the recording without its "
            f"departures {found.system_gain_dn_per_e:.4g} ± {std:.2g}: what is stated in electrons "
            "is off by as much. Give a model that was fitted to this camera."
        )


def _departures(
    model: Model, statistics: RecordingStatistics, header: RecordingHeader
) -> Departures:
    """Return what the set says of them."""
    kept = carried(model.effects)
    response = [e for e in model.effects if isinstance(e, SystemGain | Vignette)]
    blocks = [s.block for s in statistics.fit if s.block.kind == "flat"]
    times = [b.started_s for b in blocks if b.started_s is not None]
    temperatures = [b.sensor_temperature_c for b in blocks if b.sensor_temperature_c is not None]
    left = {e.name for e in model.effects if isinstance(e, Departure)} - {e.name for e in kept}
    return Departures(
        effects=Departures.tables((*kept, *response)),
        line_period_us=header.camera.line_period_us or model.camera.line_period_us or 0.0,
        time_s=float(np.mean(times)) if times else 0.0,
        temperature_c=float(np.mean(temperatures)) if temperatures else None,
        cannot_be_undone=tuple(sorted(left)),
    )


@dataclass(frozen=True)
class _Shift:
    """What a set changes by where one parameter is off by its standard uncertainty."""

    effect: str
    parameter: str
    std: float
    unit: str
    change: dict[str, Any]


def _shifts_of_parameters(
    case: _Case, model: Model, start: Corrected, found: CoefficientSet, provenance: Provenance
) -> Iterator[_Shift]:
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
            yield _Shift(name, parameter, std, told.unit, change)


def _widened(found: CoefficientSet, shifts: list[_Shift]) -> CoefficientSet:
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


def _row(found: CoefficientSet, shift: _Shift) -> BudgetRow:
    """Return the budget's row: the responsivity's relative change, of a typical column."""
    valid = found.valid
    relative = np.abs(shift.change["responsivity"][valid] / found.responsivity[valid])
    return BudgetRow(
        f"{shift.effect} {shift.parameter}", "B", "normal", shift.std, shift.unit,
        float(np.median(relative)) / shift.std, "common", "stated by the model file",
    )  # fmt: skip
