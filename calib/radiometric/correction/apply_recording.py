"""A whole recording into radiance, block by block, in constant memory."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from calib.arrays import RawLines
from calib.errors import DarkflatError, InputError
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.correction.apply import Correction
from calib.radiometric.correction.apply_file import RadianceFile, writing
from calib.radiometric.correction.apply_options import ApplyOptions
from calib.radiometric.correction.blocks_to_correct import chosen_blocks, corrections_by_block
from calib.radiometric.correction.flags import count_flags
from calib.radiometric.correction.radiance_lines import Radiance
from calib.recording.protocol import Recording

_CHUNK_BYTES = 1 << 21
"""Radiance of this size stays in a core's cache until it is written: twice the rate."""


@dataclass(frozen=True)
class Corrected:
    """What was written.

    Attributes:
        path: The HDF5 file (see `apply_file`).
        coefficient_set: The set's id.
        radiance_unit: Unit of radiance and std.
        blocks: Names of the blocks, in the order of acquisition.
        left_out: Names of the capped darks that were not asked for, and are not corrected.
        n_lines: Lines of all blocks.
        flags: How many pixels of these blocks carry each flag.
        notes: What was forced or extrapolated, with the block where it is not all of them.
    """

    path: Path
    coefficient_set: str
    radiance_unit: str
    blocks: tuple[str, ...]
    left_out: tuple[str, ...]
    n_lines: int
    flags: dict[str, int]
    notes: tuple[str, ...]


class CancelledError(DarkflatError):
    """The caller wanted no more; nothing is left of the output."""

    def __init__(self, out: Path) -> None:
        super().__init__(f"{out} was cancelled and not written.", code="cancelled")


def correct_recording(
    recording: Recording,
    coefficients: CoefficientSet,
    out: Path | str,
    *,
    options: ApplyOptions | None = None,
    progress: Callable[[float], None] | None = None,
    cancelled: Callable[[], bool] | None = None,
) -> Corrected:
    """Correct the blocks of a recording and write them to `out`; capped darks only by name.

    A dark has no radiance: half of its pixels fall below the mean dark, and would be counted with
    those of the scene.

    Args:
        recording: Of a line sensor.
        coefficients: The set to apply.
        out: The HDF5 file to write; it appears whole or not at all.
        options: Window, validity, force and so on.
        progress: Told the share of blocks done, 0 to 1.
        cancelled: Asked before each stretch of lines.

    Raises:
        InputError: The set does not match (`set-mismatch`, `outside-validity`), a block is not
            there (`no-such-block`), there are capped darks only (`only-darks`), the
            sensor is an area sensor (`area-sensor`), or `out` exists.
        CancelledError: `cancelled` said so.
    """
    path, options = Path(out), options or ApplyOptions()
    if recording.header.camera.rows is not None:
        msg = (
            f"{recording.path} is of an area sensor, and a coefficient set corrects lines: give a "
            "recording of a line sensor."
        )
        raise InputError(msg, code="area-sensor")
    blocks = chosen_blocks(recording, options.blocks)
    every_correction = corrections_by_block(recording, coefficients, options, blocks)
    corrections = [every_correction[block.block] for block in blocks]
    counts = dict.fromkeys(count_flags(np.zeros(0, np.uint8)), 0)
    n_lines = 0
    with writing(path, std=options.std) as file:
        file.set_metadata(_metadata(recording, corrections[0]))
        for done, (name, correction) in enumerate(every_correction.items(), start=1):
            block = next((b for b in blocks if b.block == name), None)
            if block is not None:
                file.begin_block(block, correction)
            for lines in _stretches(recording.frames(name)):
                if cancelled is not None and cancelled():
                    raise CancelledError(path)
                if block is None:  # only for what its lines leave in the pixels
                    correction.lines(lines, std=False)
                else:
                    n_lines += _append(file, correction, lines, counts, std=options.std)
            if progress is not None:
                progress(done / len(every_correction))
    names = tuple(block.block for block in blocks)
    every = recording.header.blocks if options.blocks is None else ()
    left_out = tuple(b.block for b in every if b.kind == "dark")
    return Corrected(
        path, coefficients.id, coefficients.radiance_unit, names, left_out, n_lines, counts,
        _notes(names, corrections),
    )  # fmt: skip


def _stretches(frames: Iterator[RawLines]) -> Iterator[RawLines]:
    """Cut frames into stretches that stay in the cache while they are corrected."""
    for frame in frames:
        n_lines = max(1, _CHUNK_BYTES // (4 * frame.shape[1]))
        for first in range(0, len(frame), n_lines):
            yield frame[first : first + n_lines]


def _append(
    file: RadianceFile,
    correction: Correction,
    lines: RawLines,
    counts: dict[str, int],
    *,
    std: bool,
) -> int:
    """Correct and write a stretch; add to `counts` and return how many lines it has."""
    corrected: Radiance = correction.lines(lines, std=std)
    file.append(corrected)
    for name, count in count_flags(corrected.flags).items():
        counts[name] += count
    return len(lines)


def _metadata(recording: Recording, correction: Correction) -> dict[str, str | float]:
    """Return what says how the lines were corrected."""
    coefficients, window = correction.coefficients, correction.window
    return {
        "coefficient_set": coefficients.id,
        "radiance_unit": coefficients.radiance_unit,
        "recording": recording.path.name,
        "camera_json": recording.header.camera.model_dump_json(exclude_none=True),
        "window": window.name,
        "window_transmittance": window.transmittance,
        "window_transmittance_std": window.std,
        "scale_relative_std": coefficients.scale_relative_std,
        "system_gain_dn_per_e": correction.terms.gain,
    }


def _notes(names: Sequence[str], corrections: Sequence[Correction]) -> tuple[str, ...]:
    """Return each note once, with the blocks that it is about where it is not all of them."""
    about: dict[str, list[str]] = {}
    for name, correction in zip(names, corrections, strict=True):
        for note in correction.notes:
            about.setdefault(note, []).append(name)
    return tuple(
        note if len(where) == len(names) else f"{note} (blocks {', '.join(where)})"
        for note, where in about.items()
    )
