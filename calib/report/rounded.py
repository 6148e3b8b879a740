"""Numbers in words: as many digits as their uncertainty warrants, units as they are set in print.

The uncertainty has two significant digits, the value as many decimals (JCGM 100:2008, 7.2.6).
"""

import math

from calib.report.style import unit_text

DIGITS = 2
"""Of an uncertainty."""
PLAIN = (-4, 6)
"""Powers of ten between which a number is written without one."""
_PRINTED = {
    "1": "", "e-": "e⁻", "e-/us": "e⁻/µs", "us": "µs", "1/s": "per second", "1/e-": "per e⁻",
    "1/DN": "per DN", "degree Celsius": "°C", "DN/e-": "DN/e⁻", "column": "columns",
    "pixel": "pixels", "e-/(radiance us)": "e⁻/(radiance µs)",
    "DN/(radiance us)": "DN/(radiance µs)",
}  # fmt: skip


def printed_unit(unit: str) -> str:
    """Return a unit as it is set in print, empty for none."""
    return _PRINTED.get(unit, unit_text(unit))


def decimals_of(std: float, digits: int = DIGITS) -> int:
    """Return after how many decimals `digits` significant ones of an uncertainty end."""
    place = math.floor(math.log10(std))
    # What rounds up to the next power of ten has a digit more than it needs.
    if round(std, digits - 1 - place) >= 10.0 ** (place + 1):
        place += 1
    return digits - 1 - place


def number(value: float, std: float, *, digits: int = DIGITS) -> str:
    """Return a value alone, with as many decimals as `digits` of its uncertainty have.

    >>> number(0.01234, 0.00067), number(12343.0, 670.0), number(1.234e-7, 5e-9)
    ('0.01234', '12340', '1.234·10⁻⁷')
    """
    value_text, _, rest = quantity(value, std, digits=digits).partition(" ± ")
    return value_text.lstrip("(") + rest.partition(")")[2]


def quantity(value: float, std: float, unit: str = "", *, digits: int = DIGITS) -> str:
    """Return value, standard uncertainty and unit; three digits where it has no uncertainty.

    >>> quantity(0.01234, 0.00067, "DN"), quantity(2.5e-7, 3.1e-8)
    ('0.01234 ± 0.00067 DN', '(2.50 ± 0.31)·10⁻⁷')
    """
    printed = printed_unit(unit) if unit else ""
    tail = f" {printed}" if printed else ""
    if not (math.isfinite(value) and math.isfinite(std) and std > 0):
        return _bare(value) + tail
    power = math.floor(math.log10(max(abs(value), std)))
    if PLAIN[0] <= power < PLAIN[1]:
        return _both(value, std, digits) + tail
    scaled = _both(value * 10.0**-power, std * 10.0**-power, digits)
    return f"({scaled})·10{raised(power)}{tail}"


def percent(share: float, std: float = math.nan, *, digits: int = DIGITS) -> str:
    """Return a share in percent, without its uncertainty.

    >>> percent(0.01234, 0.00067), percent(-0.0481)
    ('1.234 %', '-4.81 %')
    """
    return f"{number(100.0 * share, 100.0 * std, digits=digits)} %"


def raised(power: int) -> str:
    """Return an exponent in raised digits."""
    return str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def _both(value: float, std: float, digits: int) -> str:
    decimals = decimals_of(std, digits)
    shown = max(decimals, 0)
    value, std = round(value, decimals), round(std, decimals)
    return f"{value:.{shown}f} ± {std:.{shown}f}"


def _bare(value: float) -> str:
    if not math.isfinite(value) or value == 0.0:
        return f"{value:g}"
    power = math.floor(math.log10(abs(value)))
    if PLAIN[0] <= power < PLAIN[1]:
        return f"{round(value, 2 - power):.{max(2 - power, 0)}f}"
    return f"{value * 10.0**-power:.2f}·10{raised(power)}"
