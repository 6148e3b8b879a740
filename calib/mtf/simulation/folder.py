"""Writes a simulated scan as the folder of contract §6."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import tomli_w
from numpy.typing import NDArray

from calib.mtf.geometry import Scan
from calib.mtf.grating.grating import Grating
from calib.recording.durable import new_folder


def write_folder(
    path: Path,
    scan: Scan,
    grating: Grating,
    frames: NDArray[np.floating],
    missing: Sequence[int] = (),
) -> Path:
    """Write `mtf.toml` and `frames/`, whole or not at all; positions `missing` are left out."""
    table: dict[str, object] = {"m": scan.m, "n": scan.n}
    if missing:
        table["missing"] = list(missing)
    content = {
        "pitch_um": scan.pitch_um,
        "grating": {"eta2": grating.eta2, "period_um": grating.period_um},
        "scan": table,
    }
    with new_folder(path) as folder:
        (folder / "mtf.toml").write_text(tomli_w.dumps(content), encoding="utf-8")
        (folder / "frames").mkdir()
        for k, frame in enumerate(frames):
            if k not in missing:
                np.save(folder / "frames" / f"{k:03d}.npy", frame)
    return path
