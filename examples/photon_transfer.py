"""Photon transfer of two real sensors: curves, models, covariances, drawn into a folder.

    python examples/photon_transfer.py [--out docs/gallery] [--ccd12 FOLDER]

A 12-bit CCD of which only sums survive (the reference set of the EMVA 1288 package; its table lies
in the folder that --ccd12 names), and a 16-bit CCD of four taps (the frames that the package
msfc-ccd ships). What is not there is left out. Tables go to standard output, as Markdown.
"""

import argparse
import csv
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import tomli_w
from astropy.io import fits
from matplotlib.figure import Figure

from calib.arrays import RawLines
from calib.recording.folder_recording import FolderRecording
from calib.report.style import BLUE, ORANGE, house_style, new_figure
from calib.transfer.photon_transfer.curve_fit import fit_curve
from calib.transfer.photon_transfer.figures import covariances, transfer_curve
from calib.transfer.photon_transfer.means import means_of
from calib.transfer.photon_transfer.measure import photon_transfer
from calib.transfer.photon_transfer.result import PhotonTransfer

HERE = Path(__file__).resolve().parent
CCD12 = HERE.parents[1] / "shared" / "data" / "real" / "emva1288_ccd12"
CONDITIONS = "block,kind,exposure_us,level,started_s,sensor_temperature_c,lines,radiance"
RANGES_DN = (500.0, 1000.0, 1500.0, 2000.0, 2500.0, 3000.0, 3500.0, 4000.0)
STRETCHES = 8
_MASKED_ROWS, _BLANK_COLUMNS, _BESIDE_THE_MIDDLE = 20, 60, 10
"""What of a tap's image is no lit pixel, with a margin."""


def main() -> None:
    """Measure, draw and print what there is data for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("docs/gallery"))
    parser.add_argument("--ccd12", type=Path, default=CCD12)
    chosen = parser.parse_args()
    chosen.out.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory() as scratch, house_style():
        for name, figure in figures(chosen.ccd12, Path(scratch)):
            figure.savefig(chosen.out / f"photon-transfer-{name}.png")


def figures(ccd12: Path, scratch: Path) -> Iterator[tuple[str, Figure]]:
    """Yield the figures by name."""
    table = ccd12 / "ptc_table.csv"
    if table.exists():
        recording = FolderRecording(folder_of_sums(table, scratch / "ccd12"))
        found = photon_transfer(recording)
        print_models("12-bit CCD", found)
        print_jackknife(found)
        yield "ccd12", transfer_curve(found.taps[0], "Photon transfer of a 12-bit CCD")
        yield "ccd12-range", straight_by_range(recording, found)
    if (files := sample_files()) is not None:
        msfc = FolderRecording(folder_of_frames(files, scratch / "msfc"))
        found = photon_transfer(msfc)
        print_taps("CCD of four taps", found)
        yield "taps", covariances(found.taps, "Neighbours in a CCD of four taps")


def folder_of_sums(table: Path, folder: Path) -> Path:
    """Write the CCD's table as a recording folder of sums: blocks of 2 frames of 640 × 480."""
    folder.mkdir(parents=True)
    camera = {"columns": 640, "rows": 480, "bit_depth": 12}
    (folder / "recording.toml").write_text(tomli_w.dumps({"camera": camera}))
    conditions = [CONDITIONS]
    sums = ["block,samples,mean_dn,variance_dn2"]
    with table.open(newline="") as file:
        for k, row in enumerate(csv.DictReader(file)):
            for kind, level, of, time in (
                ("flat", 1, "bright", "texp_ns"), ("dark", 0, "dark", "texp_dark_ns"),
            ):  # fmt: skip
                name = f"{kind}{k:02d}"
                exposure_us = float(row[time]) / 1000.0
                conditions.append(f"{name},{kind},{exposure_us},{level},,,2,")
                sums.append(f"{name},614400,{row[f'mean_{of}_DN']},{row[f'var_{of}_DN2']}")
    (folder / "conditions.csv").write_text("\n".join(conditions) + "\n")
    (folder / "statistics.csv").write_text("\n".join(sums) + "\n")
    return folder


def sample_files() -> Path | None:
    """Return where the package msfc-ccd keeps its frames; None where it is not installed."""
    found = find_spec("msfc_ccd")
    if found is None or found.submodule_search_locations is None:
        return None
    return Path(found.submodule_search_locations[0]) / "_data" / "led"


def folder_of_frames(files: Path, folder: Path) -> Path:
    """Write the pairs of flats and darks, lit pixels alone, as a recording folder."""
    frames = {
        "flat": _pair(files, (4803, 4804)),
        "dark": _pair(files, (4860, 4861)),
    }
    (folder / "frames").mkdir(parents=True)
    for name, pair in frames.items():
        np.save(folder / "frames" / f"{name}.npy", pair)
    rows, columns = frames["flat"].shape[1:]
    camera = {
        "model": "ESIS 1", "columns": columns, "rows": rows, "bit_depth": 16,
        "taps": 4, "tap_layout": "quadrants",
    }  # fmt: skip
    (folder / "recording.toml").write_text(tomli_w.dumps({"camera": camera}))
    (folder / "conditions.csv").write_text(
        f"{CONDITIONS}\nflat,flat,2000000,1,,,2,\ndark,dark,2000000,0,,,2,\n"
    )
    return folder


def _pair(files: Path, numbers: tuple[int, int]) -> RawLines:
    images = [fits.getdata(files / f"ESIS1_{n:05d}.fit.gz") for n in numbers]
    height, width = images[0].shape
    rows = np.r_[_MASKED_ROWS : height - _MASKED_ROWS]
    half = np.r_[_BLANK_COLUMNS : width // 2 - _BESIDE_THE_MIDDLE]
    columns = np.r_[half, width - 1 - half[::-1]]
    return np.stack([image[np.ix_(rows, columns)] for image in images]).astype(np.uint16)


def straight_by_range(recording: FolderRecording, found: PhotonTransfer) -> Figure:
    """Draw, and print, K of a straight line that ends at several signals."""
    print("\n| highest mean, DN | K of a straight line, DN/e⁻ |\n|---|---|")
    tap, gains, errors = found.taps[0], [], []
    for most in RANGES_DN:
        straight = _straight(recording, most)
        gains.append(straight[0])
        errors.append(straight[1])
        print(f"| {most:.0f} | {straight[0]:.4f} ± {straight[1]:.4f} |")
    figure = new_figure(height_in=3.6)
    axes = figure.subplots()
    axes.errorbar(RANGES_DN, gains, errors, fmt="o", color=BLUE, ms=4, label="straight line")
    gain = tap.system_gain
    axes.axhspan(gain.value - gain.std, gain.value + gain.std, color=ORANGE, alpha=0.25)
    axes.axhline(gain.value, color=ORANGE, label=f"bent response: {gain.value:.4f} DN/e⁻")
    axes.set(
        title="What a straight line makes of a bent curve",
        xlabel="highest mean code in the fit, DN",
        ylabel="K, DN/e⁻",
    )
    axes.legend(loc="lower left")
    return figure


def _straight(recording: FolderRecording, most_dn: float) -> tuple[float, float]:
    tap = photon_transfer(recording, most_dn=most_dn).taps[0]
    fit = next(f for m, f in tap.choice.fits.items() if m.label == "straight")
    return fit.shape.system_gain, fit.std("system_gain")


def print_jackknife(found: PhotonTransfer) -> None:
    """Print K's standard error from stretches of signal left out one after the other.

    Residuals of neighbouring signals are alike, which errors that are taken as independent miss.
    """
    tap = found.taps[0]
    points = tap.points.where(tap.used.use)
    flats = np.flatnonzero(~points.is_dark)
    gains = []
    for group in np.array_split(flats[np.argsort(points.signal_dn[flats])], STRETCHES):
        kept = np.ones(len(points), np.bool_)
        kept[group] = False
        rest = points.where(kept)
        gains.append(fit_curve(rest, means_of(rest), tap.choice.used).shape.system_gain)
    error = float(np.sqrt((STRETCHES - 1) * np.var(gains)))
    print(f"\nK with stretches of signal left out: standard error {error:.4f} DN/e⁻")


def print_models(name: str, found: PhotonTransfer) -> None:
    """Print what every model gives."""
    tap = found.taps[0]
    print(f"\n{name}: {tap.choice.why}\n")
    print("| model | K, DN/e⁻ | β, 1e-6/DN | a00, 1e-7/e⁻ | −2 ln L | AICc | η, % | τ, % |")
    print("|---|---|---|---|---|---|---|---|")
    for model, fit in tap.choice.fits.items():
        shape = fit.shape
        eta = fit.mean_excess.relative if fit.mean_excess else float("nan")
        print(
            f"| {model.label} | {shape.system_gain:.4f} ± {fit.std('system_gain'):.4f} "
            f"| {1e6 * shape.beta_per_dn:.2f} ± {1e6 * fit.std('beta_per_dn'):.2f} "
            f"| {1e7 * shape.a00_per_e:+.1f} ± {1e7 * fit.std('a00_per_e'):.1f} "
            f"| {fit.deviance:.1f} | {fit.aicc:.1f} | {100 * eta:.3f} "
            f"| {100 * fit.variance_excess.flats.relative:.2f} |"
        )
    for figure in (found.system_gain, found.read_noise_dn, found.read_noise_e):
        print(f"\n{figure.value:.4f} ± {figure.std:.4f} {figure.unit}", end="")
    print()


def print_taps(name: str, found: PhotonTransfer) -> None:
    """Print the figures of every tap, and how neighbours correlate."""
    print(f"\n{name}\n\n| tap | K, DN/e⁻ | read noise, DN |\n|---|---|---|")
    for tap in found.taps:
        gain, read = tap.system_gain, tap.read_noise_dn
        print(
            f"| {tap.tap} | {gain.value:.4f} ± {gain.std:.4f} | {read.value:.3f} ± {read.std:.3f} |"
        )
    gain, read = found.system_gain, found.read_noise_e
    print(f"\npooled: {gain.value:.4f} ± {gain.std:.4f} DN/e⁻, {read.value:.2f} e⁻")
    print("\n| lag (rows, columns) | correlation, all taps | significance |\n|---|---|---|")
    for k, lag in enumerate(found.taps[0].points.lags):
        seen = [tap.neighbours[k] for tap in found.taps]
        weight = np.array([n.correlation_std**-2.0 for n in seen])
        mean = float(weight @ np.array([n.correlation for n in seen]) / weight.sum())
        error = float(weight.sum() ** -0.5)
        print(f"| {lag} | {mean:+.5f} ± {error:.5f} | {mean / error:+.1f} |")


if __name__ == "__main__":
    main()
