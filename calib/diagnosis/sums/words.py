"""What a diagnosis of sums says in words: what it saw, what it did not, what it cannot know."""

from dataclasses import replace

import numpy as np

from calib.diagnosis.shapes.of_effects import departures
from calib.diagnosis.sums.names import EFFECTS
from calib.forward.effects.brighter_fatter import BrighterFatter
from calib.forward.effects.nonlinearity import Nonlinearity
from calib.recording.header import RecordingHeader
from calib.transfer.photon_transfer.choice import Choice, significance
from calib.transfer.photon_transfer.curve_fit import CurveFit, Model
from calib.transfer.photon_transfer.tap_transfer import TapTransfer
from calib.transfer.photon_transfer.variance_curve import Shape

LEAST_PROBABILITY = 0.02
"""Of a candidate that is told."""


def sigma_of(choice: Choice, name: str) -> float:
    """Return by how many standard errors the effect's parameter lies from 0."""
    if choice.with_means:
        return abs(choice.beta_sigma if name == Nonlinearity.name else choice.a00_sigma)
    return abs(choice.bend_sigma)


def sentence(name: str, shape: Shape, top_dn: float) -> str:
    """Return what an operator is told of an effect: how much of it there is at the top."""
    straight = shape.linear(np.array([top_dn]))
    if name == Nonlinearity.name:
        lost = 100.0 * (1.0 - top_dn / float(straight[0]))
        return (
            f"The response bends: at {top_dn:.0f} DN above the dark level it gives {lost:.2f} % "
            "less than a straight line."
        )
    whole = replace(shape, a00_per_e=0.0).charge_variance(straight)
    lost = 100.0 * (1.0 - float((shape.charge_variance(straight) / whole)[0]))
    return (
        f"Charge repels charge: at {top_dn:.0f} DN above the dark level {lost:.2f} % of the "
        "variance is gone."
    )


def not_testable(header: RecordingHeader, fit: CurveFit) -> dict[str, str]:
    """Return why all other effects cannot be told from sums, by their names."""
    found = {}
    for kind in departures():
        if kind.name in EFFECTS.values():
            continue
        lack = kind.why_not_testable(header.blocks, header.camera)
        found[kind.name] = lack if lack is not None else _without_frames(kind.shows_in)
    if "exposure_offset" in found and fit.data.means is not None:
        k = len(fit.solution.parameters) - 1
        std = float(np.sqrt(fit.solution.covariance[k, k]))
        found["exposure_offset"] = (
            f"it is fitted beside the response, {fit.exposure_offset_us:+.2f} +- {std:.2f} us, and "
            f"not named: an offset of flats that is {_as_offset(fit):+.2f} DN beside that of darks "
            "does the same at one level"
        )
    return found


def _as_offset(fit: CurveFit) -> float:
    """Return what the exposure's offset adds to the signal, DN, at the first level."""
    rate = fit.solution.parameters[len(fit.names)]
    return float(rate * fit.exposure_offset_us)


def _without_frames(shows_in: str) -> str:
    if shows_in in {"mean", "transient"}:
        return (
            "needs the frames: of one mean per block the response, an exposure offset and the "
            "source's unrest take all there is"
        )
    return f"needs the frames: statistics.csv keeps nothing of what it shows in ({shows_in})"


def overdispersion(fit: CurveFit) -> str:
    """Return what is said of variances that scatter more than statistics allow."""
    flats = ~fit.data.points.is_dark
    found, own = fit.variance_excess.flats, float(np.median(fit.sigma[flats]))
    ordered = fit.residual[flats][np.argsort(fit.data.points.signal_dn[flats])]
    alike = float(ordered[1:] @ ordered[:-1] / (ordered @ ordered))
    return (
        f"The variances of flats scatter about the curve by {100 * found.relative:.2f} % beyond "
        f"the {100 * own:.2f} % that their samples allow, those of neighbouring signals with a "
        f"correlation of {alike:+.2f}; sums do not tell what makes it, and it counts as noise in "
        "all that is fitted."
    )


def remarks(tap: TapTransfer, model: Model) -> tuple[str, ...]:
    """Return what was looked for and is not called for, and the noise that was fitted."""
    choice, said = tap.choice, []
    if choice.with_means:
        said = [_not_called(choice, n) for p, n in EFFECTS.items() if p not in model.value]
    else:
        said = [f"{choice.why[:1].upper()}{choice.why[1:]}."]
    fit = choice.fits[model]
    if fit.mean_excess is not None and fit.mean_excess.relative > 0:
        said.append(
            f"Means of flats scatter about the response by {100 * fit.mean_excess.relative:.3f} %: "
            "the source's unrest, which counts in all that is fitted."
        )
    if fit.variance_excess.flats.relative > 0:
        said.append(overdispersion(fit))
    return tuple(said)


def _not_called(choice: Choice, name: str) -> str:
    sigma = choice.beta_sigma if name == Nonlinearity.name else choice.a00_sigma
    text = (
        f"{name} is not called for: fitted beside the other bend, it lies {sigma:+.1f} standard "
        "errors from none, these counted as variances and means scatter and not by their samples"
    )
    if name != BrighterFatter.name:
        return f"{text}."
    side = "adds variance, which it cannot" if sigma > 0 else "takes variance away"
    alone = choice.fits[Model.BRIGHTER_FATTER]
    flats = alone.variance_excess.flats
    by_itself = significance(alone.shape.a00_per_e, alone.std("a00_per_e"), flats)
    return (
        f"{text}, and there {side}; by itself it would be {by_itself:+.1f} standard errors from "
        "none, and leave the means as they are."
    )
