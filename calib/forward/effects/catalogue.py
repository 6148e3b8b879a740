"""The catalogue: one line per effect, in the physical order in which the chain runs them."""

from calib.errors import InputError
from calib.forward.effect import Effect
from calib.forward.effects.adc import Adc
from calib.forward.effects.adc_dnl import AdcDnl
from calib.forward.effects.adc_inl import AdcInl
from calib.forward.effects.amplifier_glow import AmplifierGlow
from calib.forward.effects.banding import Banding
from calib.forward.effects.black_clip import BlackClip
from calib.forward.effects.brighter_fatter import BrighterFatter
from calib.forward.effects.cosmic_rays import CosmicRays
from calib.forward.effects.cti import Cti
from calib.forward.effects.dark_current import DarkCurrent
from calib.forward.effects.dark_current_temperature import DarkCurrentTemperature
from calib.forward.effects.duplicated_lines import DuplicatedLines
from calib.forward.effects.empirical import Empirical
from calib.forward.effects.exposure_jitter import ExposureJitter
from calib.forward.effects.exposure_offset import ExposureOffset
from calib.forward.effects.full_well import FullWell
from calib.forward.effects.gain_drift import GainDrift
from calib.forward.effects.heavy_tailed_noise import HeavyTailedNoise
from calib.forward.effects.hot_pixels import HotPixels
from calib.forward.effects.illumination import Illumination
from calib.forward.effects.interpixel_capacitance import InterpixelCapacitance
from calib.forward.effects.lag import Lag
from calib.forward.effects.lamp_drift import LampDrift
from calib.forward.effects.lamp_flicker import LampFlicker
from calib.forward.effects.level_nonadditivity import LevelNonadditivity
from calib.forward.effects.line_noise import LineNoise
from calib.forward.effects.nonlinearity import Nonlinearity
from calib.forward.effects.offset import Offset
from calib.forward.effects.offset_drift import OffsetDrift
from calib.forward.effects.offset_temperature import OffsetTemperature
from calib.forward.effects.persistence import Persistence
from calib.forward.effects.read_noise import ReadNoise
from calib.forward.effects.reciprocity_failure import ReciprocityFailure
from calib.forward.effects.responsivity import Responsivity
from calib.forward.effects.rts_pixels import RtsPixels
from calib.forward.effects.saturation_knee import SaturationKnee
from calib.forward.effects.shot_noise import ShotNoise
from calib.forward.effects.spot import Spot
from calib.forward.effects.stray_light import StrayLight
from calib.forward.effects.stuck_bit import StuckBit
from calib.forward.effects.system_gain import SystemGain
from calib.forward.effects.tap_crosstalk import TapCrosstalk
from calib.forward.effects.tap_gain_drift import TapGainDrift
from calib.forward.effects.vignette import Vignette

CATALOGUE: tuple[type[Effect], ...] = (
    Illumination,
    LevelNonadditivity,
    LampDrift,
    LampFlicker,
    Spot,
    StrayLight,
    ExposureOffset,
    ExposureJitter,
    Vignette,
    ReciprocityFailure,
    Responsivity,
    DarkCurrent,
    DarkCurrentTemperature,
    HotPixels,
    AmplifierGlow,
    ShotNoise,
    BrighterFatter,
    CosmicRays,
    SaturationKnee,
    FullWell,
    Lag,
    Persistence,
    Cti,
    InterpixelCapacitance,
    ReadNoise,
    HeavyTailedNoise,
    SystemGain,
    TapGainDrift,
    GainDrift,
    Nonlinearity,
    TapCrosstalk,
    LineNoise,
    Banding,
    RtsPixels,
    Empirical,
    Offset,
    OffsetDrift,
    OffsetTemperature,
    AdcInl,
    AdcDnl,
    Adc,
    StuckBit,
    BlackClip,
    DuplicatedLines,
)

_BY_NAME = {kind.name: kind for kind in CATALOGUE}
_PLACE = {kind.name: place for place, kind in enumerate(CATALOGUE)}


def effect_named(name: str) -> type[Effect]:
    """Return the effect of that name; InputError naming all where there is none."""
    if name not in _BY_NAME:
        raise InputError(
            f"unknown effect {name!r}; allowed: {', '.join(_BY_NAME)}.", code="unknown-effect"
        )
    return _BY_NAME[name]


def place_of(effect: Effect) -> int:
    """Return where `effect` stands in the physical order."""
    return _PLACE[effect_named(effect.name).name]
