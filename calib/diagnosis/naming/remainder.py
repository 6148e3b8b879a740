"""What no effect explains: a remainder is looked at in several ways, and described."""

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.standing_out import N_STEPS
from calib.diagnosis.naming.look import IMPERFECT_SHARE, Look
from calib.diagnosis.naming.model import Model
from calib.forward.effects.lamp_flicker import LampFlicker

Floats = NDArray[np.float64]

CERTAIN_SIGMA = 5.0
"""A remainder beyond this, all ways of looking counted, is not chance."""
SMOOTH = 4
"""Degree up to which profiles of the columns are looked at one by one: among all pixels' chance a
smooth remainder drowns."""
CLAIMED = 0.5
"""Of a peak: a tone that leaves less of it is what it comes from, steady or not."""


def looks_at(model: Model, evidence: Evidence) -> tuple[Look, ...]:
    """Return the remainder of a model in all ways of looking."""
    return (
        *_means(model, evidence),
        *_pooled(model, evidence),
        *_rest(model, evidence),
        *_tones(model, evidence),
    )


def _means(model: Model, evidence: Evidence) -> list[Look]:
    residual = model.residual.means
    # Pixels that move together, as the lines of a block do, are not far off one by one.
    own = evidence.space.product(residual, residual)
    freedom = float(evidence.space.degrees_of_freedom)
    columns = np.linspace(-1.0, 1.0, evidence.sensor.n_columns)
    smooth = np.tile(legvander(columns, SMOOTH)[:, 1:].T, evidence.sensor.n_rows)
    return [
        Look("mean", ("column",), own, freedom, (residual**2).sum(axis=1)),
        _along("time", np.ones(residual.shape[1]), residual, evidence),
        *(_along("column", profile, residual, evidence) for profile in smooth),
        *_between_taps(residual, evidence),
    ]


def _between_taps(residual: Floats, evidence: Evidence) -> list[Look]:
    """Return how far the means of taps are off against those of the taps before them."""
    tap = evidence.sensor.tap.ravel()
    looks = []
    for t in range(1, evidence.sensor.n_taps):
        share = float((tap == t).sum()) / float((tap < t).sum())
        contrast = np.where(tap == t, 1.0, np.where(tap < t, -share, 0.0))
        looks.append(_along("tap", contrast, residual, evidence))
    return looks


def _along(depends: str, profile: Floats, residual: Floats, evidence: Evidence) -> Look:
    """Return how far the blocks' means are off along a profile of the pixels.

    Args:
        depends: What it follows, from block to block, beside the signal.
        profile: The same in all blocks, (n_pixels,).
        residual: What is left of the means, whitened, (n_blocks, n_pixels).
        evidence: The recording.
    """
    energies, freedom = np.zeros(len(residual)), 0
    for b, weight in enumerate(evidence.space.weight):
        white = profile * weight
        length = float(np.sqrt(white @ white))
        if length > 0:
            along2 = float(white @ residual[b] / length) ** 2
            energies[b] = along2 / (1.0 + _shared(b, white / length, evidence))
            freedom += 1
    absorbed = min(len(evidence.space.basis), max(freedom - 1, 0))
    free = max(freedom - absorbed, 1)
    return Look("mean", (depends, "signal"), float(energies.sum()), free, energies)


def _shared(b: int, unit: Floats, evidence: Evidence) -> float:
    """Return the variance along a whitened direction of unit length, by noise that lines share.

    That is the same for all pixels of the electronics, and goes with their signal of the light.
    """
    signal = float(evidence.signal_dn[b])
    variance = evidence.common.shared_dn2(signal) * evidence.common.memory
    weight = evidence.space.weight[b]
    shading = np.maximum(evidence.baseline.mean_dn[b] - evidence.baseline.offset_dn, 0.0).ravel()
    shading = shading / max(float(shading.mean()), 1e-300)
    alike = max(float(unit @ weight) ** 2, float(unit @ (weight * shading)) ** 2)
    together = float(variance) / float(evidence.n[b] * evidence.sensor.n_rows) * alike
    of_taps = evidence.common.tap_mean_dn2(float(evidence.n[b]), evidence.counts.present)
    tap = evidence.sensor.tap.ravel()
    along_taps = np.bincount(tap, unit * weight, minlength=len(of_taps))
    return together + float(of_taps @ along_taps**2)


def _pooled(model: Model, evidence: Evidence) -> list[Look]:
    n = evidence.pooled.std.size
    pooled = model.residual.rest[:n].reshape(evidence.pooled.std.shape)
    used = evidence.pooled.used
    kinds = {
        "variance": ("variance", ("signal",)),
        "kurtosis": ("tail", ("line",)),
        "columns_1": ("column_covariance", ("column",)),
        "columns_2": ("column_covariance", ("column",)),
        "lines_1": ("line_covariance", ("line",)),
        "lines_2": ("line_covariance", ("line",)),
        "rows": ("column_covariance", ("column",)),
        "partners": ("column_covariance", ("tap",)),
        "common": ("spectrum", ("line",)),
        "common_1": ("spectrum", ("line",)),
    }
    looks = []
    for kind, (statistic, depends) in kinds.items():
        where = evidence.pooled.places[kind]
        freedom = float(used[:, where].sum())
        if freedom > 0:
            energy = (pooled[:, where] ** 2).sum(axis=1)
            looks.append(Look(statistic, depends, float(energy.sum()), freedom, energy))
            averaged = pooled[:, where].sum() ** 2 / freedom
            looks.append(Look(statistic, depends, float(averaged), 1.0, energy))
    return looks


def _rest(model: Model, evidence: Evidence) -> list[Look]:
    places = evidence.whitening.places.items()
    b, of = evidence.n_blocks, {kind: model.residual.rest[where] for kind, where in places}
    onset = of["onset"].reshape(b, -1)
    events, steps, codes = (float((of[k] ** 2).sum()) for k in ("rare", "steps", "codes"))
    by_block, flat = evidence.rare_space.by_block(model.observed.rare), np.zeros(b)
    return [
        Look(
            "transient",
            ("previous_block",),
            float((onset**2).sum()),
            3.0 * (b - 1),
            (onset**2).sum(1),
        ),
        Look("tail", ("line",), events, float(evidence.rare_space.n_seen), by_block),
        Look("mean", ("column",), steps, 2.0 * N_STEPS, flat),
        Look("histogram", ("code",), codes, float(evidence.code_counts.n_numbers), flat),
    ]


def _tones(model: Model, evidence: Evidence) -> list[Look]:
    """Return the peaks of the spectra that no tone claims, and what goes round beside them."""
    where, n = evidence.whitening.places["tones"], evidence.n_blocks
    seen, left = (
        point.rest[where].reshape(n, -1).T ** 2 for point in (model.first, model.residual)
    )
    # Of a tone that is unsteady, or two that beat, some blocks have more than others.
    looks = [
        Look("spectrum", ("line",), float(energy.sum()), float(n), energy)
        for energy, whole in zip(left, seen, strict=True)
        if energy.sum() > CLAIMED * whole.sum()
    ]
    # Light that flickers in another shape than a sine flickers all the same.
    flickers = any(isinstance(member.effect, LampFlicker) for member in model.members)
    further = [f for f in evidence.further_tones if not (flickers and f.goes_with_light)]
    if further:
        deviance = float(sum(tone.deviance for tone in further))
        power = np.sum([tone.power for tone in further], axis=0)
        looks.append(Look("spectrum", ("line",), deviance, float(len(further)), power))
    return looks


def worst(model: Model, evidence: Evidence) -> tuple[Look, float]:
    """Return the way of looking in which the remainder is farthest from chance, and how far."""
    looks = looks_at(model, evidence)
    explained = explained_deviance(model, evidence)
    ranked = [(look, look.sigma(explained, len(looks))) for look in looks]
    return max(ranked, key=lambda pair: pair[1])


def unexplained_deviance(model: Model, evidence: Evidence) -> float:
    """Return by how much the remainder exceeds chance where it does so most; 0 where nowhere."""
    looks = looks_at(model, evidence)
    explained = explained_deviance(model, evidence)
    excess = (
        look.deviance - IMPERFECT_SHARE * explained - look.freedom
        for look in looks
        if look.sigma(explained, len(looks)) > CERTAIN_SIGMA
    )
    return max(excess, default=0.0)


def explained_deviance(model: Model, evidence: Evidence) -> float:
    """Return the deviance that all effects of a model explain together."""
    if not model.members:
        return 0.0
    before, after = (evidence.product(p, p) for p in (model.first, model.residual))
    return max(before - after, 0.0)
