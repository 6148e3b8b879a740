"""Real frames as recording folders."""

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import tomli_w
from astropy.io import fits
from numpy.typing import NDArray

from examples.photon_transfer import CONDITIONS

Floats = NDArray[np.float64]

BLANK, TRAIL = 50, 2
"""Columns of a tap before its lit ones, and after them: what trails behind the last lit one."""
BOX = (48, 96)
"""Rows and columns of each tap that the diagnosis looks at, those farthest from its output."""


def folder_of_taps(files: Path, folder: Path) -> Path:
    """Write a pair of flats and of darks, the four taps' pixels about the middle."""
    pairs = {"flat": (4803, 4804), "dark": (4860, 4861)}
    (folder / "frames").mkdir(parents=True)
    for name, numbers in pairs.items():
        frames = [_in_place([_lit(t) for t in taps_of(frame_of(files, n))]) for n in numbers]
        np.save(folder / "frames" / f"{name}.npy", np.stack(frames).astype(np.uint16))
    camera = {
        "model": "ESIS 1", "columns": 2 * BOX[1], "rows": 2 * BOX[0], "bit_depth": 16, "taps": 4,
        "tap_layout": "quadrants", "readout": "both",
    }  # fmt: skip
    return written(folder, camera, 2, 2_000_000)


def taps_of(frame: Floats) -> list[Floats]:
    """Return what each tap reads, (520, 1076), in the order in which it does."""
    h, w = frame.shape[0] // 2, frame.shape[1] // 2
    return [
        frame[:h, :w], frame[:h, w:][:, ::-1], frame[h:, :w][::-1], frame[h:, w:][::-1, ::-1],
    ]  # fmt: skip


def _lit(tap: Floats) -> Floats:
    return tap[-BOX[0] :, -BOX[1] - TRAIL : -TRAIL]


def _in_place(taps: list[Floats]) -> Floats:
    """Return the taps' parts as they lie on the sensor."""
    above = np.hstack([taps[0], taps[1][:, ::-1]])
    return np.vstack([above, np.hstack([taps[2][::-1], taps[3][::-1, ::-1]])])


def frame_of(files: Path, number: int) -> Floats:
    """Return a frame of the first camera, DN, (1040, 2152)."""
    return np.asarray(fits.getdata(files / f"ESIS1_{number:05d}.fit.gz"), np.float64)


def folder_of_xray(tooth: Path, folder: Path) -> Path:
    """Write flats and darks as whole counts.

    Values are whole numbers of quarter counts, and four times the flats is beyond 16 bits. Rounded
    half up every count takes four of them; rounded half to even, even counts would take five and
    odd ones three: differential nonlinearity that no converter has.
    """
    (folder / "frames").mkdir(parents=True)
    with h5py.File(tooth) as file:
        for name, key in (("flat", "data_white"), ("dark", "data_dark")):
            counts = file["exchange"][key][:]
            if not np.array_equal(4.0 * counts, np.round(4.0 * counts)):
                raise ValueError(f"{tooth}: {key} holds no quarters of counts")
            whole = np.floor(counts + 0.5).astype(np.uint16)
            np.save(folder / "frames" / f"{name}.npy", whole)
    rows, columns = whole.shape[1:]
    camera = {"model": "tooth", "columns": columns, "rows": rows, "bit_depth": 16}
    return written(folder, camera, len(whole), 100_000)


def written(folder: Path, camera: dict[str, Any], frames: int, exposure_us: int) -> Path:
    """Write header and conditions of a flat and a dark of so many frames; return the folder."""
    (folder / "recording.toml").write_text(tomli_w.dumps({"camera": camera}))
    rows = (f"{k},{k},{exposure_us},{int(k == 'flat')},,,{frames}," for k in ("flat", "dark"))
    (folder / "conditions.csv").write_text("\n".join([CONDITIONS, *rows]) + "\n")
    return folder
