"""What a member of a model contributes, linearly."""

import numpy as np

from calib.diagnosis.evidence.point import Point
from calib.diagnosis.naming.model import Member
from calib.diagnosis.naming.scores import Score
from calib.diagnosis.statistics.change import Change


def contribution(member: Member) -> Point:
    """Return what the member contributes, linearly: its strength times its direction."""
    point = member.directions[0] * _share(member)
    for (_, part), much in zip(member.course, member.course_fit, strict=True):
        point = point + part * much
    return point


def contribution_change(member: Member) -> Change:
    """Return the same of the statistics themselves."""
    change = member.changes[0] * _share(member)
    for (part, _), much in zip(member.course, member.course_fit, strict=True):
        change = change + part * much
    return change


def _share(member: Member) -> float:
    return 1.0 if member.signature.shape.fixed else member.strength / member.signature.power


def unfitted(score: Score) -> Member:
    """Return the member that a score stands for, before it is fitted."""
    signature = score.signature
    ratio = abs(score.amplitude) ** (1.0 / signature.power)
    strength = float(np.sign(score.amplitude) * ratio * signature.strength)
    strength = min(strength, signature.shape.most)
    if signature.shape.fixed:
        strength = 1.0
    return Member(
        signature, strength, {}, (0.0,), (signature.change,), (signature.point,),
        score.course, (0.0,) * len(score.course),
    )  # fmt: skip
