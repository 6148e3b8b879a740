"""AgCam's radiometric calibration of a linescan camera, from a recording to a coefficient set.

Source: Olsen, D. et al. (2010), Radiometric calibration for AgCam, Remote Sensing 2, 464-477,
Eqs. 1-3 and section 5. Where this differs, and why, is in docs/calibration.md.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from calib.arrays import Columns
from calib.forward.model import Model
from calib.radiometric.calibration import Calibration
from calib.radiometric.coefficients.provenance import Parameter, Provenance
from calib.radiometric.departures.amended import amended
from calib.radiometric.departures.model_check import check_model
from calib.radiometric.estimation.choices import Choices, MonitorUse, check_recording
from calib.radiometric.estimation.from_statistics import Determined, determine
from calib.radiometric.estimation.selection import CLIP_SIGMA
from calib.radiometric.estimation.source_uncertainty import SourceUncertainty
from calib.radiometric.estimation.vignette import ORDERS
from calib.radiometric.uniformity import (
    HELD_OUT_EVERY,
    Uniformity,
    held_out_lines,
    nearest_to_half_scale,
    uniformity,
)
from calib.recording.block_statistics import RecordingStatistics
from calib.recording.digest import DigestedWhileRead
from calib.recording.header import RecordingHeader
from calib.recording.protocol import Recording
from calib.recording.statistics import column_statistics, never
from calib.recording.tone import Tone


def calibrate(
    recording: Recording,
    *,
    radiances: Mapping[float, float] | None = None,
    radiance_unit: str | None = None,
    source: SourceUncertainty | None = None,
    tone: Tone | None = None,
    order: int | None = None,
    relative: bool = False,
    darks_required: bool = True,
    monitor: MonitorUse = "use",
    model: Model | None = None,
    held_out_every: int = HELD_OUT_EVERY,
    plan: str = "",
    origin: Mapping[str, Parameter] | None = None,
    progress: Callable[[float], None] | None = None,
    cancelled: Callable[[], bool] = never,
) -> Calibration:
    """Determine DN0, VE and QE of every column, and how sure they are.

    Args:
        recording: Flats of at least one level at two exposures, and capped darks.
        radiances: Radiance by level, in the recording's unit; goes before what blocks state.
        radiance_unit: Of `radiances` where they were computed; None takes the recording's.
        source: Type B uncertainties of the source; None takes those of the recording's header.
        tone: A synchronous tone that is removed before lines are averaged.
        order: Degree of the vignette's polynomial; None chooses it by prediction.
        relative: Accept a recording without radiances; radiance 1 is the reference level's.
        darks_required: Refuse a recording without capped darks.
        monitor: "use" corrects the light of blocks of one level by their monitor readings, where
            every flat has one and the camera sees the same changes; "ignore" does not.
        model: Its departures, such as lag, are taken out of the recording, and are carried by the
            set, so that `apply` takes them out of lines; None knows of none.
        held_out_every: One line of so many is kept from the fit to judge the result; 0 keeps none.
        plan: The plan that was run, as text, for the provenance.
        origin: Where `radiances` come from, for the provenance: it joins the parameters.
        progress: Called with the share that is done, 0 to 1.
        cancelled: Asked before each frame; True ends in CancelledError.

    Raises:
        InputError: The recording or an argument cannot be used (codes: `determine`).
        NotDeterminedError: The recording does not determine what is asked (codes: `determine`).
    """
    choices = Choices(radiances, source, order, relative, darks_required, monitor)
    check_recording(recording.header, choices)
    if model is not None:
        check_model(model, _in_unit(recording.header, radiance_unit), relative=relative)
    recording = DigestedWhileRead(recording)
    statistics = column_statistics(
        recording,
        tone=tone,
        held_out_every=held_out_every,
        progress=progress,
        cancelled=cancelled,
    )
    provenance = _provenance(
        recording, choices, tone, held_out_every, plan=plan, origin=origin or {}
    )
    header = _in_unit(recording.header, radiance_unit)
    added: dict[str, Columns] = {}
    cleared = None
    if model is None:
        determined = determine(statistics, header, provenance, choices)
    else:
        without = amended(
            statistics, header, provenance, choices, model, held_out_every=held_out_every
        )
        determined = without.determined
        added = {
            s.block.block: s.mean_dn - w.mean_dn
            for s, w in zip(statistics.held_out, without.statistics.held_out, strict=True)
        }
        cleared = statistics = without.statistics
    judged = _judge(recording, statistics, determined, held_out_every, added)
    found = determined.coefficients
    # The digest is a few frames behind, and had until now to catch up.
    digested = replace(found.provenance, recording_digest=recording.digest())
    return Calibration(
        coefficients=replace(found, provenance=digested),
        darks=determined.darks,
        uniformity=judged,
        figures=determined.figures,
        warnings=(*recording.warnings, *determined.warnings),
        without_departures=cleared,
    )


def _judge(
    recording: Recording,
    statistics: RecordingStatistics,
    determined: Determined,
    held_out_every: int,
    added_dn: Mapping[str, Columns],
) -> Uniformity | None:
    """Return the coefficients of variation on held-out lines; None where none are held out.

    What departures add to a block's mean, by its name, is taken off its single lines.
    """
    full_scale = recording.header.camera.full_scale_dn
    held_out = nearest_to_half_scale(statistics.held_out, full_scale)
    if held_out is None:
        return None
    name = held_out.block.block
    lines: Iterator[Any] = held_out_lines(recording.frames(name), held_out_every)
    if name in added_dn:
        lines = (stretch - added_dn[name] for stretch in lines)
    return uniformity(determined.coefficients, held_out, lines)


def _in_unit(header: RecordingHeader, unit: str | None) -> RecordingHeader:
    """Return the header with its radiances in `unit`."""
    if unit is None:
        return header
    source = header.source.model_copy(update={"radiance_unit": unit})
    return header.model_copy(update={"source": source})


def _provenance(
    recording: Recording,
    choices: Choices,
    tone: Tone | None,
    held_out_every: int,
    *,
    plan: str,
    origin: Mapping[str, Parameter],
) -> Provenance:
    """Return what makes the set repeatable, but for the recording's digest."""
    camera = recording.header.camera
    parameters: dict[str, Parameter] = {
        "order": choices.order,
        "relative": choices.relative,
        "held_out_every": held_out_every,
        "clip_sigma": CLIP_SIGMA,
        "orders": f"{ORDERS[0]}-{ORDERS[-1]}",
    }
    for level, radiance in (choices.radiances or {}).items():
        parameters[f"radiance_of_level_{level:g}"] = radiance
    if tone is not None:
        parameters["tone_cycles_per_pixel"] = tone.cycles_per_pixel
        parameters["tone_pixels_per_line"] = tone.pixels_per_line
    parameters |= origin
    return Provenance(
        recording_digest="",
        recording_name=recording.path.name,
        started_at=camera.started_at.isoformat() if camera.started_at else "",
        plan=plan,
        software_version=_software_version(),
        parameters=parameters,
    )


def _software_version() -> str:
    """Return darkflat's version; "" where it is not installed as a package."""
    try:
        return version("darkflat")
    except PackageNotFoundError:
        return ""
