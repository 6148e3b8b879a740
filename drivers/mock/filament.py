"""How a tungsten halogen lamp follows its current, relative to nominal.

Source: A. V. Arecchi, T. Messadi, R. J. Koshel, Field Guide to Illumination, SPIE FG11 (2007),
"Tungsten Lamps": luminous flux goes as the current's power 6.5 and voltage as its power 1.9, within
±5 % of nominal. Outside that, and in the near infrared (where the power is lower), this is a model
of the sign and size only.
"""

FLUX_POWER = 6.5
VOLTAGE_POWER = 1.9


def relative_emission(relative_current: float) -> float:
    """Emission relative to nominal at `relative_current` (1 = nominal)."""
    return float(max(relative_current, 0.0) ** FLUX_POWER)


def relative_voltage(relative_current: float) -> float:
    """Voltage relative to nominal at `relative_current`."""
    return float(max(relative_current, 0.0) ** VOLTAGE_POWER)


def relative_current(relative_voltage: float) -> float:
    """Current relative to nominal at `relative_voltage`: where the voltage limit holds it."""
    return float(max(relative_voltage, 0.0) ** (1.0 / VOLTAGE_POWER))
