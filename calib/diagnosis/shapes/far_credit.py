"""What heavy tails, tracks of charge and bits that stick are credited with beyond sums of counts.

Counts of what is far out are summed and whitened so that fits are linear; a handful of samples
where chance makes none is worth far more than their number. What the samples themselves say, less
what the sums do, is a credit of the name. Each name is credited with all that it explains, so two
together are charged what they share. Where bits that flip explain the samples far better, others
are credited with what they explain beside those. Readings that only rise are tails, too, unlike the
tracks in that nothing is beside them and that they follow no exposure.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import combinations
from math import log

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.shapes.far_claims import Cause, Claim, counted, deviance_beside, likeliest
from calib.diagnosis.shapes.far_events import FarEvents, far_events
from calib.diagnosis.shapes.far_flips import Bit, flipped, stuck
from calib.diagnosis.shapes.far_likelihood import hit, raised, tailed
from calib.forward.effects.cosmic_rays import CosmicRays
from calib.forward.effects.heavy_tailed_noise import HeavyTailedNoise
from calib.forward.effects.stuck_bit import StuckBit

TAIL_NOISES = (6.0, 15.0)
"""Standard deviations of the noisier readings that are tried, over the read noise."""
CHARGE_NOISES = (4.0, 12.0, 40.0, 150.0, 600.0)
"""Mean charges that a pixel is left by a track, likewise."""
MOST = 100.0
"""Deviance that two names are credited with at the most, and the likeliest one beyond the next."""
LEFT = 0.1
"""Of what one explains, so much may be left, since its law may be another one: Laplace's."""
SURELY = 16.0
"""So much more have bits that flip to explain: two samples are a power of two off by chance."""
TAILS, RAYS, BITS = HeavyTailedNoise.name, CosmicRays.name, StuckBit.name


@dataclass(frozen=True)
class FarCredit:
    """Deviance beyond that of sums.

    Attributes:
        tails: Of heavy tails.
        rays: Of tracks of charge.
        bits: Of bits that stick, by which and at which value, the likeliest first; only those that
            explain something.
        shared: What two names are credited with twice, by name, and then by the other.
    """

    tails: float = 0.0
    rays: float = 0.0
    bits: Mapping[Bit, float] = field(default_factory=dict)
    shared: Mapping[str, Mapping[str, float]] = field(
        default_factory=lambda: {name: {} for name in (TAILS, RAYS, BITS)}
    )


def far_credit(evidence: Evidence) -> FarCredit:
    """Return what the samples far out say of these names."""
    events = far_events(evidence)
    if len(events.off_dn) == 0:
        return FarCredit()
    sums = counted(evidence)
    bits = _of_bits(events, evidence, sums)
    bit = max(bits, key=lambda each: bits[each].credit)
    claims = {**_of_others(events, evidence, sums, bits[bit]), BITS: bits[bit]}
    credit = {name: claim.credit for name, claim in claims.items()}
    _, second, _ = sorted(credit.values(), reverse=True)
    beyond, most = max(second - MOST, 0.0), min(second, MOST) + MOST
    held = {name: min(max(each - beyond, 0.0), most) for name, each in credit.items()}
    shared: dict[str, dict[str, float]] = {name: {} for name in claims}
    for one, other in combinations(claims, 2):
        twice = _shared(claims[one], claims[other], held[one], held[other])
        shared[one][other] = shared[other][one] = twice
    of_bits = {b: min(max(claim.credit - beyond, 0.0), most) for b, claim in bits.items()}
    likely = sorted((b for b in bits if of_bits[b] > 0), key=lambda b: -bits[b].credit)
    return FarCredit(held[TAILS], held[RAYS], {b: of_bits[b] for b in likely}, shared)


def _of_bits(events: FarEvents, evidence: Evidence, sums: Mapping[str, float]) -> dict[Bit, Claim]:
    """Return what each bit that sticks at each value claims."""
    causes = stuck(events, evidence)
    price = 2.0 * log(len(causes))
    return {
        (bit, value): Claim((cause,), (), price, {k: sums[k] for k in _counts_of(bit, value)})
        for (bit, value), cause in causes.items()
    }


def _counts_of(bit: int, value: int) -> tuple[str, str]:
    """Return which counts hold samples that a bit has moved: those of its own only far out."""
    return ("above", f"raised_{bit}") if value else ("below", f"lowered_{bit}")


def _of_others(
    events: FarEvents, evidence: Evidence, sums: Mapping[str, float], bit: Claim
) -> dict[str, Claim]:
    """Return what tails and tracks claim, beside flips if these explain far more."""
    tried: dict[str, list[Cause]] = {
        TAILS: [each(events, evidence, x) for each in (tailed, raised) for x in TAIL_NOISES],
        RAYS: [hit(events, evidence, x) for x in CHARGE_NOISES],
    }
    best = {name: likeliest(causes, ()) for name, causes in tried.items()}
    least = max(deviance_beside((cause,), ()) for cause in best.values())
    any_bit = flipped(events, evidence)
    flips = max(deviance_beside(bit.causes, ()) - bit.price, deviance_beside((any_bit,), ()))
    beside = (*bit.causes, any_bit) if flips > least + SURELY else ()
    counts = {TAILS: ("above", "below"), RAYS: ("above", "tracks")}
    return {
        name: Claim(
            (best[name],), beside, 2.0 * log(len(tried[name])), {k: sums[k] for k in counts[name]}
        )
        for name in tried
    }


def _shared(one: Claim, other: Claim, held: float, held_other: float) -> float:
    """Return what two claims, credited with so much each, are credited with twice."""
    if len(one.beside) != len(other.beside):
        # What tails explain beside flips these have no part in.
        return 0.0
    both = max(one.and_(other).credit, one.credit, other.credit)
    # What one explains beside the other, and beside what the other's shape leaves.
    too, other_too = (both - (1.0 + LEFT) * each.credit for each in (other, one))
    return min(max(held - too, held_other - other_too, 0.0), held, held_other)
