"""The mean signal of a frame that a monochromator lights, or of one with its shutter closed."""

from pathlib import Path

import numpy as np

from calib.errors import InputError


def mean_signal(path: Path, columns: tuple[int, int]) -> tuple[float, float]:
    """Return the mean code of a frame's lit columns and its standard uncertainty, DN.

    Args:
        path: A .npy file of codes, (n_lines, n_columns), at least two lines.
        columns: First and last lit column, both included, 0-based.

    The uncertainty is that of the mean over lines: what columns have in common within a line (lamp
    noise) is in it. How columns differ is not: the same columns are lit at every wavelength.
    """
    try:
        frame = np.load(path, allow_pickle=False)
    except FileNotFoundError as error:
        raise InputError(f"{path} is missing: add it.", code="not-found") from error
    except (OSError, ValueError) as error:
        raise InputError(f"{path} cannot be read as .npy: {error}.", code="unreadable") from error
    if frame.ndim != 2 or len(frame) < 2:
        msg = f"{path} has shape {frame.shape}: give (n_lines, n_columns) with two lines or more."
        raise InputError(msg, code="wrong-shape")
    first, last = columns
    if not 0 <= first <= last < frame.shape[1]:
        msg = f"Columns {first} to {last} do not lie in the {frame.shape[1]} columns of {path}."
        raise InputError(msg, code="wrong-columns")
    lines = frame[:, first : last + 1].mean(axis=1, dtype=np.float64)
    return float(lines.mean()), float(lines.std(ddof=1) / np.sqrt(len(lines)))
