"""What a simulated camera refuses, and how it rounds what it accepts."""

from math import isfinite

from drivers.errors import SettingRefusedError
from drivers.mock.limits import CameraLimits, Span
from drivers.ports import CameraSettings


def accepted(wanted: CameraSettings, limits: CameraLimits, device: str) -> CameraSettings:
    """Return `wanted` as the camera takes it, rounded to its steps.

    Raises:
        SettingRefusedError: Code `setting-out-of-range`, `setting-off-step` or
            `pixel-format-unknown`; the message names the setting, its value and what would do.
    """
    _check_region(wanted, limits, device)
    if wanted.pixel_format not in limits.formats:
        raise SettingRefusedError(
            f"{device}: no pixel format {wanted.pixel_format}; it has {', '.join(limits.formats)}",
            device=device,
            code="pixel-format-unknown",
        )
    line_period_us = _in_range(
        "line_period_us", wanted.line_period_us, limits.line_period_us, device
    )
    within = Span(
        limits.exposure_us.low,
        min(limits.exposure_us.high, line_period_us),
        limits.exposure_us.step,
    )
    return CameraSettings(
        exposure_us=_in_range("exposure_us", wanted.exposure_us, within, device),
        line_period_us=line_period_us,
        frame_lines=wanted.frame_lines,
        n_columns=wanted.n_columns,
        first_column=wanted.first_column,
        n_rows=wanted.n_rows,
        first_row=wanted.first_row,
        pixel_format=wanted.pixel_format,
        gain_db=_in_range("gain_db", wanted.gain_db, limits.gain_db, device),
        black_level_dn=_in_range(
            "black_level_dn", wanted.black_level_dn, limits.black_level_dn, device
        ),
    )


def _check_region(wanted: CameraSettings, limits: CameraLimits, device: str) -> None:
    step = limits.column_step
    _in_range("frame_lines", wanted.frame_lines, limits.frame_lines, device)
    last = limits.columns - wanted.n_columns
    _in_range("n_columns", wanted.n_columns, Span(step, limits.columns, step), device)
    _in_range("first_column", wanted.first_column, Span(0, last, step), device)
    for name in ("n_columns", "first_column"):
        value = getattr(wanted, name)
        if value % step:
            raise SettingRefusedError(
                f"{device}: {name} = {value} is not a multiple of {step}; "
                f"{value - value % step} would do",
                device=device,
                code="setting-off-step",
            )
    _check_rows(wanted, limits, device)


def _check_rows(wanted: CameraSettings, limits: CameraLimits, device: str) -> None:
    if (wanted.n_rows is None) != (limits.rows is None):
        has = "no rows" if limits.rows is None else f"{limits.rows} rows"
        raise SettingRefusedError(
            f"{device}: n_rows = {wanted.n_rows}, but this camera has {has}",
            device=device,
            code="setting-out-of-range",
        )
    if wanted.n_rows is not None and limits.rows is not None:
        _in_range("n_rows", wanted.n_rows, Span(1, limits.rows, 1), device)
    last = (limits.rows or 0) - (wanted.n_rows or 0)
    _in_range("first_row", wanted.first_row, Span(0, last, 1), device)


def _in_range(name: str, value: float, span: Span, device: str) -> float:
    rounded = span.rounded(value) if isfinite(value) else value
    if not span.holds(rounded):
        raise SettingRefusedError(
            f"{device}: {name} = {value:g} is outside {span.low:g} .. {span.high:g}",
            device=device,
            code="setting-out-of-range",
        )
    return rounded
