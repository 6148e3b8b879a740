"""Shapes that the recording itself tells: which pixels are hot, which codes are off, by how much.

A template of such an effect drawn at random has next to nothing in common with what was recorded.
These are fitted to the residual of the baseline, and pay for what they were fitted with.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import log

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.shapes.far_credit import TAIL_NOISES, FarCredit, far_credit
from calib.diagnosis.shapes.faulty_tap import faulty_tap
from calib.diagnosis.shapes.jumping_shapes import jumping_shapes
from calib.diagnosis.shapes.repeated import repeated_shapes
from calib.diagnosis.shapes.shape import Shape
from calib.diagnosis.shapes.stop_shapes import stop_shapes
from calib.diagnosis.shapes.turning_shapes import turning_shapes
from calib.forward.effects.adc_dnl import AdcDnl
from calib.forward.effects.adc_inl import AdcInl
from calib.forward.effects.black_clip import BlackClip
from calib.forward.effects.cosmic_rays import CosmicRays
from calib.forward.effects.duplicated_lines import DuplicatedLines
from calib.forward.effects.heavy_tailed_noise import HeavyTailedNoise
from calib.forward.effects.hot_pixels import HotPixels
from calib.forward.effects.rts_pixels import RtsPixels
from calib.forward.effects.stuck_bit import StuckBit

Floats = NDArray[np.float64]

COMBS = (2, 4, 8, 16)
"""Periods of code widths that are told one by one."""
BITS = 4
"""So many are looked at of those that may stick."""
TRACK_NOISES = (6.0, 12.0, 40.0, 150.0, 600.0)
"""Charges of tracks in a pixel that are tried, over the read noise."""
LEAST_CHANCE = 1e-3
"""With which a bit is looked for that sticks at times."""


def told_shapes(evidence: Evidence) -> dict[str, tuple[Shape, ...]]:
    """Return the shapes of those effects that are not looked for blindly, by name."""
    far = far_credit(evidence)
    rays = _of_noise(CosmicRays, "per_pixel_s", "electrons", TRACK_NOISES, evidence)
    tails = _of_noise(HeavyTailedNoise, "share", "std_e", TAIL_NOISES, evidence)
    return {
        HotPixels.name: _hot(evidence),
        RtsPixels.name: jumping_shapes(evidence),
        AdcInl.name: turning_shapes(evidence),
        AdcDnl.name: _dnl(evidence),
        StuckBit.name: _stuck(evidence, far),
        BlackClip.name: stop_shapes(evidence),
        CosmicRays.name: _credited(rays, far.rays, far),
        DuplicatedLines.name: repeated_shapes(evidence),
        HeavyTailedNoise.name: _credited(tails, far.tails, far),
    }


def _of_noise(
    kind: type[CosmicRays | HeavyTailedNoise],
    strength: str,
    charge: str,
    noises: tuple[float, ...],
    evidence: Evidence,
) -> tuple[Shape, ...]:
    """Return shapes of single samples that differ by a charge, e-, told in units of the noise."""
    gain = float(
        np.where(evidence.baseline.gain_dn_per_e > 0, evidence.baseline.gain_dn_per_e, 1.0).mean()
    )
    noise_e = float(np.sqrt(evidence.baseline.read_variance_dn2.mean())) / gain
    default = kind()
    unit = float(getattr(default, strength))
    return tuple(
        Shape(
            kind(**{strength: unit, charge: noise * noise_e}),
            ((strength, unit, 0.0),),
            two_sided=False,
        )
        for noise in noises
    )


def _credited(shapes: Sequence[Shape], credit: float, far: FarCredit) -> tuple[Shape, ...]:
    return tuple(
        replace(each, credit=credit, shared=tuple(far.shared[each.name].items())) for each in shapes
    )


def _hot(evidence: Evidence) -> tuple[Shape, ...]:
    """Return the pixels that grow with the exposure, each at its own rate."""
    growing = evidence.growing
    if growing is None or len(growing.pixels) == 0:
        return ()
    gain = evidence.baseline.gain_dn_per_e[evidence.sensor.tap].ravel()[growing.pixels]
    rates = tuple((growing.dn_per_us / np.where(gain > 0, gain, 1.0)).tolist())
    pixels = tuple(int(p) for p in growing.pixels)
    freedom = len(pixels) * (1.0 + log(evidence.sensor.n_pixels))
    template = HotPixels(pixels=pixels, rates_e_per_us=rates)
    varied = (("rates_e_per_us", rates, 0.0),)
    return (Shape(template, varied, two_sided=False, freedom=freedom),)


def _dnl(evidence: Evidence) -> tuple[Shape, ...]:
    """Return widths drawn at random, and those of each short period that the histogram tells."""
    depth = evidence.sensor.camera.bit_depth
    shapes = [Shape(AdcDnl(bit_depth=depth), (("width_std_dn", 0.2, 0.0),), two_sided=False)]
    counts = evidence.code_counts
    for period in COMBS:
        widths = np.clip(counts.comb(period), 0.0, None)
        if not np.isfinite(widths).all() or np.ptp(widths) == 0:
            continue
        template = AdcDnl(width_std_dn=0.0, widths_dn=tuple(widths.tolist()), bit_depth=depth)
        varied = (("widths_dn", tuple((widths - 1.0).tolist()), 1.0),)
        # Of a period's numbers one is the mean, and one the strength, which others do not pay for.
        free = float(period - 2)
        shapes.append(Shape(template, varied, two_sided=False, freedom=free))
    return tuple(shapes)


def _stuck(evidence: Evidence, far: FarCredit) -> tuple[Shape, ...]:
    """Return the bits that look most as if they stuck, at 0 and at 1, of all taps or of one."""
    bits = dict.fromkeys([*map(int, suspect_bits(evidence)[:BITS]), *_likeliest(far)])
    suspect = [(bit, value) for bit in bits for value in (0, 1)]
    layout, n_taps = evidence.sensor.camera.tap_layout, evidence.sensor.n_taps
    shapes: list[Shape] = []
    for bit, value in suspect:
        chance = _told_chance(bit, value, evidence)
        for tap in dict.fromkeys((None, faulty_tap(bit, value, evidence))):
            unit = chance if tap is None else min(chance * n_taps, 1.0)
            template = StuckBit(bit=bit, value=value)
            if tap is not None:
                template = replace(template, only_tap=tap, tap_layout=layout)
            shape = Shape(template, (("probability", unit, 0.0),), two_sided=False)
            shapes += _credited([shape], far.bits.get((bit, value), 0.0), far)
    return tuple(shapes)


def _likeliest(far: FarCredit) -> list[int]:
    """Return the bit that the samples far out tell, if any."""
    return [bit for bit, _ in far.bits][:1]


def _told_chance(bit: int, value: int, evidence: Evidence) -> float:
    """Return the chance with which a bit sticks that the histogram tells of samples that moved.

    What the histogram's roughness says grows as its square: a signature taken at a small chance
    explains a tenth of what one at the right chance does.
    """
    counts = evidence.code_counts
    held = (np.arange(len(counts.expected)) >> bit & 1) == value
    could, gone = (float(x[~held].sum()) for x in (counts.expected, counts.residual()[0]))
    return float(np.clip(-gone * counts.samples / max(could, 1.0), LEAST_CHANCE, 1.0))


def suspect_bits(evidence: Evidence) -> NDArray[np.intp]:
    """Return the bits of the codes, those first that look most as if they stuck at times."""
    depth = evidence.sensor.camera.bit_depth
    counts, rare = evidence.code_counts, evidence.rare_space
    score = np.zeros(depth)
    for bit in range(4):
        ratio = counts.comb(2 << bit)
        score[bit] = abs(ratio[: 1 << bit].mean() - 1.0) * np.sqrt(counts.samples)
    score[4:] = np.abs(counts.high_bits(counts.residual()[0]))
    return np.argsort(-np.maximum(score, rare.flips(rare.seen)[:depth]), kind="stable")
