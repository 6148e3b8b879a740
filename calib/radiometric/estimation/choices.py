"""What the caller of a calibration decides, and what cannot be calibrated at all."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, get_args

from calib.errors import InputError, NotDeterminedError
from calib.radiometric.estimation.radiance_table import LevelGroups
from calib.radiometric.estimation.source_uncertainty import SourceUncertainty
from calib.recording.header import RecordingHeader

MonitorUse = Literal["use", "ignore"]


@dataclass(frozen=True)
class Choices:
    """What the caller decides.

    Attributes:
        radiances: Radiance by level; goes before what the blocks state.
        source: Type B uncertainties; None takes them from the recording's header.
        order: Degree of the vignette's polynomial; None chooses it.
        relative: Accept a recording without any radiance; the scale is then relative.
        darks_required: Refuse a recording without capped darks.
        monitor: Whether a monitor's readings may correct the light of blocks of one level.
    """

    radiances: Mapping[float, float] | None = None
    source: SourceUncertainty | None = None
    order: int | None = None
    relative: bool = False
    darks_required: bool = True
    monitor: MonitorUse = "use"


def check_recording(header: RecordingHeader, choices: Choices) -> None:
    """Refuse what cannot be calibrated at all."""
    if header.camera.rows is not None:
        message = (
            "The recording is of an area sensor, and AgCam's method is for a line of columns: give "
            "a recording of a line sensor, or one row of the area's as such a recording."
        )
        raise InputError(message, code="area-sensor")
    if choices.order is not None and not 2 <= choices.order <= 20:
        message = f"The vignette's order is {choices.order}: give 2 to 20, or none to choose it."
        raise InputError(message, code="bad-order")
    if choices.monitor not in get_args(MonitorUse):
        message = f"The monitor is to be {choices.monitor!r}: say 'use' or 'ignore'."
        raise InputError(message, code="bad-monitor")
    kinds = {block.kind for block in header.blocks}
    if "flat" not in kinds:
        raise no_flats()
    if "dark" not in kinds and choices.darks_required:
        message = (
            "The recording has no capped dark, so that the intercepts cannot be verified: record "
            "darks, or ask for a calibration without them."
        )
        raise NotDeterminedError(message, code="missing-darks")


def no_flats() -> NotDeterminedError:
    """Return what is said of a recording without a line of uniform light."""
    message = "The recording has no flat: record uniform light at several exposures."
    return NotDeterminedError(message, code="no-flats")


def check_radiance(groups: LevelGroups, choices: Choices) -> None:
    """Refuse a recording without any radiance, unless a relative scale will do."""
    if not (groups.known.any() or choices.relative):
        message = (
            "No flat has a radiance, so that there is no radiance scale: give the radiance of "
            "each level, or ask for a relative calibration."
        )
        raise NotDeterminedError(message, code="no-radiance")
