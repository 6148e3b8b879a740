"""Draws the usual links between expected electrons and codes in one compiled pass."""

import math

import numpy as np
from numpy.random import Generator

from calib.arrays import RawLines
from calib.forward.chain import ExpectedElectrons
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect
from calib.forward.effects.adc import Adc
from calib.forward.effects.full_well import FullWell
from calib.forward.effects.offset import Offset
from calib.forward.effects.read_noise import ReadNoise
from calib.forward.effects.shot_noise import ShotNoise
from calib.forward.effects.system_gain import SystemGain
from calib.kernels.noise import draw_codes

_KNOWN = (ShotNoise, FullWell, ReadNoise, SystemGain, Offset, Adc)
_NEEDED = (ShotNoise, SystemGain, Adc)


def can_fuse(after_light: tuple[Effect, ...]) -> bool:
    """Return whether the compiled pass holds all these links."""
    kinds = [type(effect) for effect in after_light]
    return all(kind in _KNOWN for kind in kinds) and all(kind in kinds for kind in _NEEDED)


def draw_fused(
    after_light: tuple[Effect, ...], expected: ExpectedElectrons, at: Conditions, rng: Generator
) -> RawLines:
    """Return codes, (n_lines, *sample); `can_fuse` of the links must hold."""
    sample = expected.light.shape[1:]
    full_well_e, read_std_e, full_scale_dn = math.inf, 0.0, 0
    gain, offset = np.ones(sample), np.zeros(sample)
    for effect in after_light:
        match effect:
            case FullWell():
                full_well_e = effect.electrons
            case ReadNoise():
                read_std_e = effect.std_e
            case SystemGain():
                gain = effect.pixels(sample, at.gain_db)
            case Offset():
                offset = effect.pixels(sample, at.black_level_dn)
            case Adc():
                full_scale_dn = effect.full_scale_dn
    # The kernel knows lines alone: a frame is a long one.
    codes = draw_codes(
        expected.light.reshape(len(expected.light), -1),
        expected.line_factor,
        expected.dark.ravel(),
        read_std_e=read_std_e,
        gain_dn_per_e=gain.ravel(),
        offset_dn=offset.ravel(),
        full_scale_dn=full_scale_dn,
        full_well_e=full_well_e,
        key=int(rng.integers(1 << 64, dtype=np.uint64)),
    )
    return codes.reshape(-1, *sample)
