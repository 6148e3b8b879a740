"""How far a hidden effect is from every other name: sight times the sine of the angle between.

A signature is all that an effect does to block means, variances and correlations of neighbours,
over standard errors and without what the baseline absorbs. Where another effect's signature, at
the best strength, is the same, no diagnosis can tell them apart. Effects that show in
distributions of codes or in scatter alone have no signature here, and are far from all others.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import inf, sqrt

import numpy as np
from numpy.random import default_rng

from tests.concealed.generator.case import Case
from tests.concealed.generator.catalogue import LISTED
from tests.concealed.generator.mechanism import Mechanism, Stage, strength_at
from tests.concealed.generator.mechanisms.drifting import Drifting
from tests.concealed.generator.setting import Setting
from tests.concealed.ideal.correlations import correlation_signature
from tests.concealed.ideal.expected import Expected, expected
from tests.concealed.ideal.means import excess_of, mean_signature, variance_signature
from tests.concealed.ideal.quiet import Floats
from tests.concealed.ideal.sight import LINEAR_COUPLING, NO_SHIFT

_DRAWS = 2
_RUNG = 0.7
_KINDS = (
    "next column", "next but one column", "next row", "next sample", "partner",
    "partner of the column before",
)  # fmt: skip


def nearest_name(case: Case, sight: Sequence[float]) -> list[tuple[float, str]]:
    """Return of each hidden effect how far the nearest other name is, and that name.

    In standard deviations; infinite and "" where none is near.
    """
    setting = _brief(case.setting)
    plain = list(expected(setting, ()))
    own = [signature(one, plain, setting) for one in case.mechanisms]
    others = []
    if any(mine.any() for mine in own):
        others = [(one.name, signature(one, plain, setting)) for one in _candidates(setting)]
    found = []
    for one, mine, seen in zip(case.mechanisms, own, sight, strict=True):
        if not mine.any():
            found.append((inf, ""))
            continue
        alike = [(x.name, signature(x, plain, setting)) for x in _of_the_same_course(one, setting)]
        distances = [
            (seen * _sine(mine, other), name)
            for name, other in (*others, *alike)
            if name != one.name
        ]
        found.append(min(distances, default=(inf, "")))
    return found


def signature(one: Mechanism, plain: Sequence[Expected], setting: Setting) -> Floats:
    """Return the effect's signature as one vector."""
    blocks, columns = len(plain), setting.sensor.columns
    shown = correlation_signature(one, plain)
    parts = [shown.get(kind, np.zeros((blocks, columns))).ravel() for kind in _KINDS]
    n_pixels = setting.sensor.rows * columns
    if one.stage >= Stage.QUANTISATION or one.name in NO_SHIFT:
        return np.concatenate([*parts, np.zeros(2 * blocks * n_pixels)])
    hidden = list(expected(setting, (one,)))
    spread = np.zeros(blocks * n_pixels)
    if one.name not in LINEAR_COUPLING:
        spread = variance_signature(plain, excess_of(plain, hidden))
    return np.concatenate([*parts, mean_signature(plain, hidden).ravel(), spread])


def _sine(one: Floats, other: Floats) -> float:
    lengths = sqrt(float(one @ one) * float(other @ other))
    if lengths == 0:
        return 1.0
    return sqrt(max(0.0, 1.0 - (float(one @ other) / lengths) ** 2))


def _candidates(setting: Setting) -> Iterator[Mechanism]:
    """Yield every other effect that the plan could show, in a few draws of each known shape."""
    for name, kind in LISTED.items():
        if kind.stage >= Stage.QUANTISATION or not kind.can_show(setting):
            continue
        strength = strength_at(kind.reach(setting), _RUNG)
        for shape in kind.shapes:
            for draw in range(_DRAWS):
                yield kind.draw(strength, shape, setting, default_rng([draw, len(name)]))


def _of_the_same_course(one: Mechanism, setting: Setting) -> Iterator[Mechanism]:
    """Yield every other drift in the course that `one`, if it is one, takes: no draw finds it."""
    if not isinstance(one, Drifting):
        return
    for name, kind in LISTED.items():
        if name != one.name and issubclass(kind, Drifting) and kind.can_show(setting):
            strength = strength_at(kind.reach(setting), _RUNG)
            drawn = kind.draw(strength, one.shape, setting, default_rng(len(name)))
            assert isinstance(drawn, Drifting)
            yield replace(drawn, sign=one.sign, constant=one.constant)


def _brief(setting: Setting) -> Setting:
    """Return the plan with few samples a block: signatures are of blocks."""
    blocks = tuple(replace(b, n_samples=min(b.n_samples, 6)) for b in setting.plan.blocks)
    return Setting(setting.sensor, replace(setting.plan, blocks=blocks))
