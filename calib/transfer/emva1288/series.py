"""The recording as the standard wants it: flats by exposure, each with its dark."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.errors import InputError, NotDeterminedError
from calib.recording.header import Block, RecordingHeader
from calib.transfer.emva1288.block_figures import BlockFigures

SAME_EXPOSURE = 1e-3
"""Exposures that differ by less, relatively, are the same: cameras round what they read back."""
SAME_TEMPERATURE_C = 1.0


@dataclass(frozen=True)
class Series:
    """Flats in the order of their signal, and the darks.

    Attributes:
        flats: (n_flats,) by mean code.
        darks: (n_darks,) in the order of acquisition.
        dark_of: Index of each flat's dark, (n_flats,).
        light: Exposure times level (or radiance, relative to that at level 1) of each flat, µs.
        temperatures: Darks of like temperature together, coldest first: indices of each group.
        own_temperature: The group that was taken at the flats' temperature.
        warnings: What was odd but usable; one sentence each.
    """

    flats: tuple[BlockFigures, ...]
    darks: tuple[BlockFigures, ...]
    dark_of: NDArray[np.int64]
    light: NDArray[np.float64]
    temperatures: tuple[tuple[int, ...], ...]
    own_temperature: int
    warnings: tuple[str, ...]


def series_of(blocks: Sequence[BlockFigures], header: RecordingHeader, where: str) -> Series:
    """Sort a recording's blocks; `where` names it in errors.

    Raises:
        NotDeterminedError: `no-flats`, `no-darks`, `too-few-frames`, `one-exposure`.
    """
    usable = [b for b in blocks if b.n_frames >= 2 and np.isfinite(b.variance_dn2)]
    single = [b.block.block for b in blocks if b not in usable]
    flats = sorted((b for b in usable if b.block.kind == "flat"), key=lambda b: b.mean_dn)
    darks = [b for b in usable if b.block.kind == "dark"]
    _check(blocks, flats, darks, where)
    groups = _temperatures(darks)
    own = _nearest_group(groups, darks, flats)
    light = _light(flats, header)
    if len({round(float(each), 9) for each in light}) < 2:
        raise NotDeterminedError(
            f"{where} holds flats at one exposure and level alone: record several, up to "
            "saturation",
            code="one-exposure",
        )
    dark_of, warnings = _pair(flats, darks, groups[own])
    if single:
        warnings = (
            f"left out, fewer than two frames: block(s) {', '.join(single)}",
            *warnings,
        )
    return Series(tuple(flats), tuple(darks), dark_of, light, groups, own, warnings)


def _check(
    blocks: Sequence[BlockFigures],
    flats: Sequence[BlockFigures],
    darks: Sequence[BlockFigures],
    where: str,
) -> None:
    kinds = [b.block.kind for b in blocks]
    for kind, code, what in (
        ("flat", "no-flats", "flats at several exposures"),
        ("dark", "no-darks", "capped darks at the flats' exposures"),
    ):
        if kind not in kinds:
            raise NotDeterminedError(f"{where} holds no {kind} block: record {what}", code=code)
    if not flats or not darks:
        raise NotDeterminedError(
            f"{where} holds no {'flat' if not flats else 'dark'} block of two frames or more: "
            "temporal noise takes two frames under the same conditions",
            code="too-few-frames",
        )


def _light(flats: Sequence[BlockFigures], header: RecordingHeader) -> NDArray[np.float64]:
    """Return exposure times relative radiance, µs: by certificate if it covers all, else level."""
    unit = [f.block.radiance for f in flats if f.block.level == 1.0 and f.block.radiance]
    known = [f.block.radiance for f in flats]
    if unit and all(known):
        relative = np.array(known, dtype=np.float64) / float(np.mean(np.array(unit, np.float64)))
    else:
        relative = np.array([f.block.level for f in flats])
    exposure = np.array([f.block.exposure_us for f in flats])
    light: NDArray[np.float64] = exposure * relative
    if np.any(light <= 0):
        dark = next(f.block.block for f, h in zip(flats, light, strict=True) if h <= 0)
        raise InputError(
            f"block {dark} is a flat at level 0 of {header.camera.model or 'the camera'}: give "
            "its level in conditions.csv, or call it a dark",
            code="flat-without-light",
        )
    return light


def _temperatures(darks: Sequence[BlockFigures]) -> tuple[tuple[int, ...], ...]:
    """Group darks whose temperatures follow each other closely; one group where any is unknown."""
    known = [d.block.sensor_temperature_c for d in darks]
    if any(each is None for each in known):
        return (tuple(range(len(darks))),)
    at = np.array(known, dtype=np.float64)
    order = np.argsort(at, kind="stable")
    breaks = np.flatnonzero(np.diff(at[order]) > SAME_TEMPERATURE_C) + 1
    return tuple(tuple(sorted(map(int, part))) for part in np.split(order, breaks))


def temperature_of(indices: Sequence[int], darks: Sequence[BlockFigures]) -> float:
    """Return the mean sensor temperature of these darks, °C; NaN where unknown."""
    known = [darks[k].block.sensor_temperature_c for k in indices]
    return float(np.mean([np.nan if each is None else each for each in known]))


def _nearest_group(
    groups: Sequence[Sequence[int]], darks: Sequence[BlockFigures], flats: Sequence[BlockFigures]
) -> int:
    known = [f.block.sensor_temperature_c for f in flats]
    warm = [each for each in known if each is not None]
    if not warm or len(groups) == 1:
        return int(np.argmax([len(group) for group in groups]))
    apart = [abs(temperature_of(group, darks) - float(np.mean(warm))) for group in groups]
    return int(np.argmin(apart))


def _pair(
    flats: Sequence[BlockFigures], darks: Sequence[BlockFigures], group: Sequence[int]
) -> tuple[NDArray[np.int64], tuple[str, ...]]:
    """Return each flat's dark: of its exposure, with most frames; else the nearest exposure."""
    chosen, missing = [], []
    exposures = {darks[k].block.exposure_us for k in group}
    for flat in flats:
        at = flat.block.exposure_us
        alike = [k for k in group if same_exposure(darks[k].block, at)]
        if not alike:
            missing.append(at)
            nearest = min(exposures, key=lambda each: abs(each - at))
            alike = [k for k in group if darks[k].block.exposure_us == nearest]
        chosen.append(max(alike, key=lambda k: darks[k].n_frames))
    return np.array(chosen), _missing(sorted(set(missing)), exposures)


def _missing(missing: Sequence[float], exposures: set[float]) -> tuple[str, ...]:
    if not missing:
        return ()
    if len(exposures) == 1:
        only = next(iter(exposures))
        return (
            f"darks at {only:g} µs alone stand for every exposure: the dark current's part of "
            "mean and variance is taken off wrongly; record darks at the flats' exposures",
        )
    return (
        f"no darks at {', '.join(f'{each:g}' for each in missing)} µs: those of the nearest "
        "exposure are taken",
    )


def same_exposure(block: Block, exposure_us: float) -> bool:
    """Tell whether a block's exposure is this one."""
    return abs(block.exposure_us - exposure_us) <= SAME_EXPOSURE * exposure_us
