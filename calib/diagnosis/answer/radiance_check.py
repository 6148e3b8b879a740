"""What the plain calibration gets wrong of radiance, if the fitted model is true.

    error = L' / L - 1,    L' = (DN(L, t) - DN0') / (slope' t)

DN(L, t) is what the baseline beside the effects, with them, gives of radiance L; DN0' and slope'
are those of the plain fit. L is the radiance that the flats were told to have, at their exposures
and times. What an effect of the source does is no error of the camera: a scene is not lit by that
lamp. It counts as far as it bent DN0' and slope' and no further.
"""

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.answer.radiance_error import RadianceError
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.naming.model import Member, Model
from calib.forward.effect import Stage

Floats = NDArray[np.float64]

DARKER = 0.01
"""Flats of less than this share of the largest signal are left out: 0 divides no error."""


def radiance_error(model: Model, evidence: Evidence) -> RadianceError | None:
    """Return the error of the plain calibration; None where nothing was found or no flat lit."""
    change = model.change
    if change is None:
        return None
    base = evidence.baseline
    # What a plain fit leaves, and what it took of the source's own for the camera's.
    means = _beside_a_fit(change.means, evidence) - sum(
        (_contribution(m) for m in model.members if m.effect.stage == Stage.SOURCE),
        np.zeros_like(change.means),
    )
    signal = (base.slope * base.dose).reshape(means.shape)
    level = np.median(signal, axis=1)
    scenes = np.array([block.kind == "scene" for block in evidence.table.blocks])
    lit = np.flatnonzero((level > DARKER * level.max()) & ~evidence.table.dark & ~scenes)
    left = _left_unsure(model, evidence)
    rows = [_of_flat(means[b], signal[b], left[b], evidence.space.weight[b] > 0) for b in lit]
    kept = [(b, row) for b, row in zip(lit, rows, strict=True) if row is not None]
    if not kept:
        return None
    values = np.array([row for _, row in kept])
    names = tuple(evidence.table.names[b] for b, _ in kept)
    return RadianceError(names, level[[b for b, _ in kept]], *values.T)


def _of_flat(
    means: Floats, signal: Floats, left: Floats, used: NDArray[np.bool_]
) -> tuple[float, float, float, float] | None:
    used = used & (signal > 0)
    if not used.any():
        return None
    error = means[used] / signal[used]
    low, middle, high = (float(x) for x in np.percentile(error, (5.0, 50.0, 95.0)))
    return middle, low, high, float(np.sqrt(np.mean((left[used] / signal[used]) ** 2)))


def _contribution(member: Member) -> Floats:
    power = 1.0 if member.signature.shape.fixed else member.strength / member.signature.power
    return np.asarray(member.changes[0].means * power)


def _left_unsure(model: Model, evidence: Evidence) -> Floats:
    """Return by how much the means are unsure, DN, with what pixels absorb fitted anew."""
    total = np.zeros_like(evidence.space.weight)
    for member in model.members:
        # A shape without a strength has no uncertainty of it.
        first = 1 if member.signature.shape.fixed else 0
        for change, std in zip(member.changes[first:], member.std[first:], strict=True):
            total += (_beside_a_fit(change.means, evidence) * std) ** 2
    return np.sqrt(total)


def _beside_a_fit(means: Floats, evidence: Evidence) -> Floats:
    """Return what of means, DN, a plain fit's offsets and slopes do not take for their own."""
    white, weight = evidence.space.project(means), evidence.space.weight
    return np.divide(white, weight, out=np.zeros_like(white), where=weight > 0)
