"""A calibration without the departures of a model, and what their parameters leave unsure."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from calib.forward.departure import Departure
from calib.forward.effects.system_gain import SystemGain
from calib.forward.effects.vignette import Vignette
from calib.forward.model import Model
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.coefficients.departures import Departures
from calib.radiometric.coefficients.provenance import Provenance
from calib.radiometric.departures.corrected_statistics import Corrected
from calib.radiometric.departures.fitted_chain import carried
from calib.radiometric.departures.model_check import check_model, model_findings
from calib.radiometric.departures.shared_noise import shared_noise
from calib.radiometric.departures.uncertain_parameters import (
    Case,
    shifts_of_parameters,
    widened,
)
from calib.radiometric.estimation.choices import Choices
from calib.radiometric.estimation.from_statistics import Determined, determine
from calib.radiometric.estimation.sensor_noise import PHOTON_TRANSFER
from calib.recording.block_statistics import RecordingStatistics
from calib.recording.header import RecordingHeader

GAIN_SIGMA = 5.0
"""A system gain that is off by so many of its standard uncertainties is not by chance."""


@dataclass(frozen=True)
class Amended:
    """The calibration and the statistics that it was made from."""

    determined: Determined
    statistics: RecordingStatistics


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
    case = Case(statistics, header, choices, held_out_every)
    corrected = case.corrected(model)
    found = determine(corrected.statistics, header, provenance, choices)
    shifts = list(shifts_of_parameters(case, model, corrected, found.coefficients, provenance))
    coefficients = _with_shared_noise(widened(found.coefficients, shifts), corrected)
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


def _with_shared_noise(found: CoefficientSet, corrected: Corrected) -> CoefficientSet:
    """Return the set with what shared noise leaves unsure in its gain and read noise."""
    if found.provenance.parameters["system_gain_method"] != PHOTON_TRANSFER:
        return found
    added = shared_noise(corrected.statistics.fit, corrected.shared_noise, found.camera)
    return replace(
        found,
        system_gain_dn_per_e_std=float(
            np.hypot(found.system_gain_dn_per_e_std, added.system_gain_dn_per_e)
        ),
        read_noise_e_std=float(np.hypot(found.read_noise_e_std, added.read_noise_e)),
    )
