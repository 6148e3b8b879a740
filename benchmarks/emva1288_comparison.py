"""`python -m benchmarks.emva1288_comparison`: our data sheet beside the package `emva1288`'s.

Both reduce the same images of a camera drawn here, whose truth is known: pairs of flats and darks
at 30 exposures to beyond saturation, and 64 of each at half of it. Printed, in Markdown: the
truth, both values, their difference in our standard uncertainties, and why they differ.
"""

import argparse
import json
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.random import Generator

from calib.recording.open import open_recording
from calib.transfer.emva1288.data_sheet import data_sheet
from calib.transfer.emva1288.sheet import DataSheet

_PEER = Path(__file__).with_name("emva1288_peer.py")
GAIN, NOISE_E, OFFSET_DN, FULL_SCALE_DN = 0.25, 8.0, 60.0, 4095
EFFICIENCY, PHOTONS_PER_US, DARK_E_PER_S = 0.6, 250.0, 40_000.0
PRNU, DSNU_E, LINES = 0.01, 5.0, 0.3
BEND = 0.01
HALF_US, STACK = 52.0, 64
EXPOSURES_US = (2.0, *np.arange(4.0, 120.0, 4.0))


@dataclass(frozen=True)
class Compared:
    """A figure: its name in both, the factor to our unit, the truth, why they differ."""

    ours: str
    theirs: str
    factor: float
    truth: float | None
    why: str


SAME = "we divide by rows − 1 and columns − 1, they by pixels − 1"
STACK_DARK = "we also take the 64 frames at half of saturation"
HIGHPASS = "they do not filter; the filter also leaves out 9 pixels at each edge"
ROWS = (
    Compared("system_gain_dn_per_e", "K", 1, GAIN, STACK_DARK),
    Compared("temporal_dark_noise_dn", "sigma_y_dark", 1, np.sqrt((GAIN * NOISE_E) ** 2 + 1 / 12),
             "we weigh darks by their frames"),
    Compared("read_noise_e", "sigma_d", 1, NOISE_E, "of both above"),
    Compared("responsivity_dn_per_photon", "R", 1, None, STACK_DARK),
    Compared("quantum_efficiency", "QE", 0.01, None, "of both above"),
    Compared("saturation_capacity_photons", "u_p_sat", 1, None,
             "the flat of the largest variance (release 3.1); ours is where 0.15 % clip"),
    Compared("saturation_capacity_e", "u_e_sat", 1, None, "as photons"),
    Compared("sensitivity_threshold_photons", "u_p_min", 1, None,
             "σ/K + 1/2 (release 3.1); ours is Eq. 27"),
    Compared("snr_max_db", "SNR_max_dB", 1, None, "as saturation"),
    Compared("dynamic_range_db", "DR_dB", 1, None, "as saturation and threshold"),
    Compared("linearity_error_min_percent", "LE_min", 1, None, STACK_DARK),
    Compared("linearity_error_max_percent", "LE_max", 1, None, STACK_DARK),
    Compared("dark_current_mean_e_per_s", "u_I_mean", 1, DARK_E_PER_S,
             "we weigh darks by their frames"),
    Compared("dark_current_variance_e_per_s", "u_I_var", 1, DARK_E_PER_S,
             "we weigh darks by their frames"),
    Compared("dsnu_unfiltered_e", "DSNU1288", 1, None, SAME),
    Compared("dsnu_e", "DSNU1288", 1, None, HIGHPASS),
    Compared("dsnu_row_e", "DSNU1288_row", 1, None, HIGHPASS),
    Compared("dsnu_column_e", "DSNU1288_col", 1, None, HIGHPASS),
    Compared("dsnu_pixel_e", "DSNU1288_pixel", 1, None, HIGHPASS),
    Compared("prnu_unfiltered_percent", "PRNU1288", 1, None, SAME),
    Compared("prnu_percent", "PRNU1288", 1, 100 * PRNU * np.sqrt(1 + 2 * LINES**2), HIGHPASS),
    Compared("prnu_row_percent", "PRNU1288_row", 1, 100 * PRNU * LINES, HIGHPASS),
    Compared("prnu_column_percent", "PRNU1288_col", 1, 100 * PRNU * LINES, HIGHPASS),
    Compared("prnu_pixel_percent", "PRNU1288_pixel", 1, 100 * PRNU, HIGHPASS),
)  # fmt: skip


def main() -> None:
    """Draw, reduce twice, print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--peers", type=Path, default=Path(".venv-peers/bin/python"))
    parser.add_argument("--rows", type=int, default=240)
    parser.add_argument("--columns", type=int, default=320)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="darkflat-emva1288-") as folder:
        draw(Path(folder), (asked.rows, asked.columns), np.random.default_rng(asked.seed))
        ours = data_sheet(open_recording(folder))
        theirs = peer(asked.peers, Path(folder))
    print("\n".join(table(ours, theirs)))


def peer(python: Path, folder: Path) -> dict[str, float]:
    """Return what the package makes of the folder."""
    done = subprocess.run(
        [str(python), str(_PEER), str(folder), "stack-dark", "stack-flat"],
        check=True, stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    found: dict[str, float] = json.loads(done.stdout)
    return found


def table(ours: DataSheet, theirs: dict[str, float]) -> list[str]:
    """Return the rows in Markdown."""
    lines = [
        "| figure | truth | ours | emva1288 | difference, u | why |",
        "|---|---|---|---|---|---|",
    ]
    for row in ROWS:
        known, other = ours[row.ours], row.factor * theirs[row.theirs]
        truth = "" if row.truth is None else f"{row.truth:.6g}"
        apart = (other - known.value) / known.std
        lines.append(
            f"| {row.ours} | {truth} | {known.value:.6g} ± {known.std:.2g} | {other:.6g} | "
            f"{apart:+.2f} | {row.why} |"
        )
    return lines


def draw(folder: Path, shape: tuple[int, int], rng: Generator) -> None:
    """Write a recording folder of the camera."""
    prnu, dsnu = (size * pattern(shape, rng) for size in (PRNU, DSNU_E))
    uneven = 1.0 - 0.05 * (np.linspace(-1, 1, shape[1]) ** 2 - 1 / 3)
    (folder / "frames").mkdir()
    rows = ["block,kind,exposure_us,level,started_s,sensor_temperature_c,lines,radiance"]
    for kind, level in (("dark", 0), ("flat", 1)):
        wanted = [(f"{kind}-{t:g}", t, 2) for t in EXPOSURES_US]
        for name, exposure_us, frames in (*wanted, (f"stack-{kind}", HALF_US, STACK)):
            electrons = EFFICIENCY * PHOTONS_PER_US * exposure_us * level * (1 + prnu) * uneven
            electrons = electrons + DARK_E_PER_S * exposure_us * 1e-6
            drawn = rng.poisson(electrons, (frames, *shape)) + dsnu
            signal = GAIN * (drawn + rng.normal(0.0, NOISE_E, drawn.shape))
            dn = OFFSET_DN + signal * (1.0 - BEND * signal / FULL_SCALE_DN)
            codes = np.clip(np.rint(dn), 0, FULL_SCALE_DN).astype(np.uint16)
            np.save(folder / "frames" / f"{name}.npy", codes)
            rows.append(f"{name},{kind},{exposure_us},{level},,,{frames},")
    (folder / "conditions.csv").write_text("\n".join(rows) + "\n")
    (folder / "recording.toml").write_text(
        f"[camera]\nrows = {shape[0]}\ncolumns = {shape[1]}\nbit_depth = 12\n[source]\n"
        f'kind = "led"\nwavelength_nm = 530.0\nphotons_per_pixel_per_us = {PHOTONS_PER_US}\n'
    )


def pattern(shape: tuple[int, int], rng: Generator) -> np.ndarray:
    """Return a pattern of pixels of size 1, with rows and columns of size LINES."""
    rows, columns = shape
    lines = rng.normal(0.0, LINES, (rows, 1)) + rng.normal(0.0, LINES, (1, columns))
    return np.asarray(rng.normal(0.0, 1.0, shape) + lines)


if __name__ == "__main__":
    main()
