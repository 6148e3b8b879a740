"""All mechanisms by name, in the order in which those of one stage act."""

from tests.concealed.generator.mechanism import Mechanism
from tests.concealed.generator.mechanisms.codes import (
    AdcDnl,
    AdcInl,
    BlackClip,
    DuplicatedLines,
    StuckBit,
)
from tests.concealed.generator.mechanisms.collection import (
    BrighterFatter,
    CosmicRays,
    SaturationKnee,
)
from tests.concealed.generator.mechanisms.drifts import (
    GainDrift,
    OffsetDrift,
    OffsetTemperature,
    TapGainDrift,
)
from tests.concealed.generator.mechanisms.electronics import (
    Banding,
    HeavyTailedNoise,
    LineNoise,
    Nonlinearity,
    RtsPixels,
)
from tests.concealed.generator.mechanisms.exposure import (
    ExposureJitter,
    ExposureOffset,
    ReciprocityFailure,
)
from tests.concealed.generator.mechanisms.source import (
    LampDrift,
    LampFlicker,
    LevelNonadditivity,
    StrayLight,
)
from tests.concealed.generator.mechanisms.thermal import (
    AmplifierGlow,
    DarkCurrent,
    DarkCurrentTemperature,
    HotPixels,
)
from tests.concealed.generator.mechanisms.transfer import Cti, Lag, Persistence
from tests.concealed.generator.mechanisms.unlisted_light import (
    BreathingShading,
    MovingFringes,
    RestlessResponse,
    TurningSource,
)
from tests.concealed.generator.mechanisms.unlisted_volts import (
    CounterOffset,
    GainAfterOtherTap,
    LinkErrors,
    PingPongGain,
    SupplyDroop,
)
from tests.concealed.generator.mechanisms.volts import InterpixelCapacitance, TapCrosstalk

_LISTED: tuple[type[Mechanism], ...] = (
    LampDrift, LampFlicker, LevelNonadditivity, StrayLight,
    ExposureOffset, ExposureJitter, ReciprocityFailure,
    DarkCurrent, DarkCurrentTemperature, HotPixels, AmplifierGlow,
    CosmicRays, BrighterFatter, SaturationKnee,
    Lag, Persistence, Cti,
    InterpixelCapacitance, TapCrosstalk, TapGainDrift, GainDrift, OffsetDrift, OffsetTemperature,
    LineNoise, Banding, RtsPixels, HeavyTailedNoise, Nonlinearity,
    AdcInl, AdcDnl, StuckBit, BlackClip, DuplicatedLines,
)  # fmt: skip
_UNLISTED: tuple[type[Mechanism], ...] = (
    MovingFringes, BreathingShading, TurningSource, RestlessResponse,
    GainAfterOtherTap, CounterOffset, SupplyDroop, LinkErrors, PingPongGain,
)  # fmt: skip

LISTED = {kind.name: kind for kind in _LISTED}
"""What a diagnosis has a name for."""
UNLISTED = {kind.name: kind for kind in _UNLISTED}
"""What it has none for."""
ALL = LISTED | UNLISTED

RADIANCE = frozenset({
    "lamp_drift", "level_nonadditivity", "stray_light", "exposure_offset", "reciprocity_failure",
    "dark_current", "dark_current_temperature", "hot_pixels", "amplifier_glow", "saturation_knee",
    "lag", "persistence", "cti", "tap_crosstalk", "tap_gain_drift", "gain_drift", "offset_drift",
    "offset_temperature", "nonlinearity", "adc_inl", "black_clip",
})  # fmt: skip
"""What shifts means, and so the radiance that is recovered."""
