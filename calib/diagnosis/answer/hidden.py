"""What an effect hid as: what the plain model had taken of it for its own.

The plain model is fitted to a recording alone, and once more beside the effects that were found.
Where the two differ, a coefficient of the plain fit holds what is none of its own. Of one effect
among several it is the step that the plain fit would take to absorb what that effect contributes.
"""

from collections.abc import Sequence

import numpy as np

from calib.diagnosis.answer.absorbed import Absorbed
from calib.diagnosis.answer.amended import beside
from calib.diagnosis.baseline.baseline import Baseline
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.given.given_model import line_std, noise_std
from calib.diagnosis.naming.model import Member, Model
from calib.diagnosis.naming.rebase import rebased
from calib.diagnosis.statistics.change import Change

LEAST = 0.2
"""What is a smaller part of its notable size is not told."""
BESIDE = 0.4
"""A second coefficient is told where it is so large beside the first."""


def absorbed_by_plain(model: Model, evidence: Evidence) -> tuple[Absorbed, ...]:
    """Return how the plain fit is off by all that was found together."""
    return _compared(evidence.baseline, beside(model, evidence), evidence)


def absorbed_of(k: int, model: Model, evidence: Evidence) -> tuple[Absorbed, ...] | None:
    """Return how it is off by member `k`; None where that cannot be told from the others' part."""
    if len(model.members) == 1:
        return absorbed_by_plain(model, evidence)
    member = model.members[k]
    if member.signature.shape.fixed:
        return None
    true = beside(model, evidence)
    alone = rebased(true, _contribution(member), evidence)
    return _compared(alone, true, evidence)


def hid_as(absorbed: Sequence[Absorbed] | None) -> str:
    """Return a sentence of what an effect hid as."""
    if absorbed is None:
        return ""
    told = sorted((a for a in absorbed if a.weight >= LEAST), key=lambda a: -a.weight)
    if not told:
        return "No coefficient of the plain model hid it."
    second = told[1:2] if told[1:] and told[1].weight >= BESIDE * told[0].weight else []
    return f"It hid as {' and '.join(a.text for a in [told[0], *second])}."


def _contribution(member: Member) -> Change:
    """Return what the member adds to the statistics, linearly."""
    return member.changes[0] * (member.strength / member.signature.power)


def _compared(plain: Baseline, true: Baseline, evidence: Evidence) -> tuple[Absorbed, ...]:
    gains_std, reads_std = noise_std(evidence)
    offset_std, slope_std = line_std(evidence)
    scale = float(np.sqrt(max(len(gains_std), 1)))
    gain = [float(b.gain_dn_per_e.mean()) for b in (plain, true)]
    slope = [float(b.slope.mean()) for b in (plain, true)]
    offset = [float(b.offset_dn.mean()) for b in (plain, true)]
    found = [
        Absorbed("dark offset", offset[0], offset[1], offset[0] - offset[1], offset_std, "DN"),
        _relative("response", slope, slope_std, "DN/(radiance us)"),
    ]
    if min(gain) > 0:
        read = [_read_noise_e(b) for b in (plain, true)]
        read_std = float(reads_std.mean()) / scale / (2.0 * max(read[1], 1e-3) * gain[1] ** 2)
        found += [
            _relative("system gain", gain, float(gains_std.mean()) / scale, "DN/e-"),
            _relative("read noise", read, read_std, "e-"),
        ]
    return tuple(found)


def _relative(name: str, values: Sequence[float], std: float, unit: str) -> Absorbed:
    plain, true = values
    scale = max(abs(true), 1e-300)
    return Absorbed(name, plain, true, (plain - true) / scale, std / scale, unit)


def _read_noise_e(base: Baseline) -> float:
    """Return the mean read noise, rounding taken off."""
    variance = np.maximum(base.read_variance_dn2 - 1.0 / 12.0, 0.0)
    return float((np.sqrt(variance) / base.gain_dn_per_e).mean())
