"""Derives the coefficients that calibration should find from the chain's links."""

from collections.abc import Mapping

import numpy as np

from calib.arrays import Pixels, SampleShape
from calib.forward.effect import Effect
from calib.forward.effects.dark_current import DarkCurrent
from calib.forward.effects.dark_current_temperature import DarkCurrentTemperature
from calib.forward.effects.offset import Offset
from calib.forward.effects.read_noise import ReadNoise
from calib.forward.effects.responsivity import Responsivity
from calib.forward.effects.system_gain import SystemGain
from calib.forward.effects.vignette import Vignette
from calib.forward.truth import Truth
from calib.recording.frame_codes import sample_shape
from calib.recording.header import CameraHeader


def truth_of(links: Mapping[str, Effect], camera: CameraHeader) -> Truth:
    """Return the truth at the camera's own gain and black level; a missing link adds nothing."""
    n = sample_shape(camera)
    offset, vignette = links.get("offset"), links.get("vignette")
    responsivity, gain = links.get("responsivity"), links.get("system_gain")
    read_noise = links.get("read_noise")
    k = gain.pixels(n, camera.gain_db) if isinstance(gain, SystemGain) else np.ones(n)
    electrons = responsivity.pixels(n) if isinstance(responsivity, Responsivity) else np.ones(n)
    lens = vignette if isinstance(vignette, Vignette) else Vignette()
    return Truth(
        dark_offset_dn=offset.pixels(n, camera.black_level_dn)
        if isinstance(offset, Offset)
        else np.zeros(n),
        vignette=lens.profile(n),
        responsivity=electrons * k,
        axis_column=lens.axis(n)[-1],
        system_gain_dn_per_e=float(k.mean()),
        read_noise_e=read_noise.std_e if isinstance(read_noise, ReadNoise) else 0.0,
        dark_signal_dn_per_us=_dark_rates(links, n) * k,
    )


def _dark_rates(links: Mapping[str, Effect], sample: SampleShape) -> Pixels:
    """Return the dark current, e-/us, (*sample,)."""
    rates = np.zeros(sample)
    steady, warm = links.get("dark_current"), links.get("dark_current_temperature")
    if isinstance(steady, DarkCurrent):
        rates = rates + steady.rates(sample)
    if isinstance(warm, DarkCurrentTemperature):
        rates = rates + warm.rates(sample, warm.reference_c)
    return rates
