"""What a scan shows of the bench beside the pixel: errors that were found, named and corrected."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.mtf.measure import Measurement

_FAR = 6.0
_SURE = 5.0
_GAUSSIAN = 1.4826  # standard deviation of a Gaussian in units of its median absolute deviation


@dataclass(frozen=True)
class StageError:
    """A stage position that stands apart.

    Attributes:
        position: k.
        error_um: (x, y), about the mean of the positions that are not far astray.
        std_um: Of both.
    """

    position: int
    error_um: tuple[float, float]
    std_um: tuple[float, float]


def stage_outliers(found: Measurement) -> tuple[StageError, ...]:
    """Return the positions whose error stands far above what the others scatter by."""
    error, std = found.fit.stage_um
    spread = _GAUSSIAN * np.median(np.abs(error - np.median(error, axis=0)), axis=0)
    apart = (np.abs(error) > _FAR * np.hypot(spread, std)).any(axis=1)
    positions = found.fit.state.sampling.frames
    return tuple(
        StageError(positions[k], (error[k, 0], error[k, 1]), (std[k, 0], std[k, 1]))
        for k in np.flatnonzero(apart)
    )


def stage_rms_um(found: Measurement) -> float:
    """Return the rms of stage errors that do not stand apart, their noise taken off, µm."""
    error, std = found.fit.stage_um
    apart = {each.position for each in stage_outliers(found)}
    keep = [
        k for k, position in enumerate(found.fit.state.sampling.frames) if position not in apart
    ]
    excess: NDArray[np.floating] = (error[keep] ** 2 - std[keep] ** 2).mean(axis=0)
    return float(np.sqrt(max(excess.mean(), 0.0)))


def warnings(found: Measurement) -> tuple[str, ...]:
    """Return a sentence for whatever is not as it should be, and what was done about it."""
    told = [
        f"stage position {each.position:03d} is off by {each.error_um[0]:+.3f} µm along x and"
        f" {each.error_um[1]:+.3f} µm along y (± {max(each.std_um):.1g}): corrected"
        for each in stage_outliers(found)
    ]
    told += [
        f"frame {position:03d} does not show the pattern: left out"
        for position in found.without_pattern
    ]
    missing = sorted(
        set(range(found.scan.positions))
        - set(found.fit.state.sampling.frames)
        - set(found.without_pattern)
    )
    if missing:
        named = ", ".join(f"{position:03d}" for position in missing)
        which = "position %s was" if len(missing) == 1 else "positions %s were"
        told.append(f"stage {which % named} not recorded: done without")
    return (*told, *_about_geometry(found), *_about_pixels(found), *_about_light(found))


def _about_geometry(found: Measurement) -> list[str]:
    told = []
    tilt, std = found.fit.tilt_rad
    if abs(tilt) > max(_SURE * std, 1e-5):
        told.append(
            f"the detector is tilted by {np.degrees(tilt):+.4f}° beyond atan(m/n): corrected"
        )
    scale, std = found.fit.scale
    if abs(scale) > max(_SURE * std, 1e-5):
        told.append(f"the pattern is {-100 * scale:+.4f} % larger than period_um says: corrected")
    if stage_rms_um(found) > 0.002 * found.scan.step_um:
        told.append(f"stage positions scatter by {stage_rms_um(found):.3f} µm rms: corrected")
    return told


def _about_pixels(found: Measurement) -> list[str]:
    told = []
    odd = int((~found.fit.good).sum())
    if odd:
        told.append(f"{odd} pixels do not follow the pattern as the others do: left out")
    return told


def _about_light(found: Measurement) -> list[str]:
    """Return what the harmonics say of the mean light: T must come to 1 at frequency 0."""
    excess, std = found.psf.mean_excess
    if abs(excess) <= _SURE * std:
        return []
    told = f"the mean light is {100 * excess:+.2g} % (± {100 * std:.1g} %) off what the harmonics"
    told += f" of a PSF on {found.support} × {found.support} pixels say: remove the dark and stray"
    return [f"{told} light, or look for crosstalk from beyond"]
