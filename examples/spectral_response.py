"""A monochromator scan reduced, as in AgCam's Fig. 2, and the radiance of a sphere in the band.

    python examples/spectral_response.py [--scan FOLDER] [--lamps LAMPS.csv] [--out docs/gallery]

Without a folder a scan is simulated, with a source that drifts by 2 % and a filter whose band moves
to the blue as interference filters' do (effective index 2).
"""

import argparse
import csv
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.random import Generator, default_rng
from numpy.typing import NDArray

from calib.radiometric.report.spectral import draw_response, draw_shifts
from calib.radiometric.spectral.band_radiance import band_radiance
from calib.radiometric.spectral.band_radiance_spectra import LampSpectra
from calib.radiometric.spectral.spectral_response import SpectralResponse
from calib.radiometric.spectral.spectral_response_angles import angular_variation
from calib.radiometric.spectral.spectral_response_scan import SpectralScan
from calib.report.style import GREY, ORANGE, house_style, new_figure

ANGLES_DEG = (-4.0, -2.0, 0.0, 2.0, 4.0)
WAVELENGTH_NM = np.arange(741.0, 931.0, 3.0)
Numbers = NDArray[np.float64]


def write(path: Path, header: str, rows: Sequence[Sequence[object]]) -> None:
    """Write a table as CSV."""
    with path.open("w", newline="") as file:
        table = csv.writer(file)
        table.writerow(header.split())
        table.writerows(rows)


def filter_and_sensor(wavelength_nm: Numbers, angle_deg: float) -> Numbers:
    """Return a NIR band from 780 to 890 nm at normal incidence, times a sensor that weakens."""
    blue_shift = np.sqrt(1 - (np.sin(np.deg2rad(angle_deg)) / 2.0) ** 2)
    nm = wavelength_nm / blue_shift
    band = 1 / (1 + np.exp(-(nm - 780) / 2.5)) / (1 + np.exp((nm - 890) / 3.5))
    ripple = 1 + 0.03 * np.sin(nm / 6.0)
    return band * ripple * (1 - 0.003 * (wavelength_nm - 780)) + 3e-4


def simulate_scan(folder: Path, rng: Generator) -> None:
    """Write the folder of a scan whose truth is `filter_and_sensor`."""
    noise_dn, reading, n = 0.15, 1e-3, len(WAVELENGTH_NM)
    responsivity = 0.45 + 0.0008 * (WAVELENGTH_NM - 741)
    power_w = 1e-6 * (1 + 0.4 * np.sin(WAVELENGTH_NM / 25))
    scan, reference = [], []
    for number, angle in enumerate(ANGLES_DEG):
        drift, start_s = 0.02 * rng.uniform(-1, 1), 900.0 * number
        at_s = start_s + np.linspace(60.0, 840.0, n)
        power = power_w * (1 + drift * (at_s - start_s) / 900.0)
        dark = 3.5 + noise_dn * rng.normal(size=n)
        signal = 1.3e8 * power * filter_and_sensor(WAVELENGTH_NM, angle) * np.cos(angle / 30)
        signal += 3.5 + noise_dn * rng.normal(size=n)
        for w, t, s, d in zip(WAVELENGTH_NM, at_s, signal, dark, strict=True):
            scan.append((w, angle, t, 500.0, s, noise_dn, d, noise_dn))
        for when, time_s, factor in (("before", 0, 1.0), ("after", 900, 1 + drift)):
            current = power_w * factor * responsivity * (1 + reading * rng.normal(size=n))
            for w, i in zip(WAVELENGTH_NM, current, strict=True):
                reference.append((when, angle, w, start_s + time_s, i, reading * i))
    write(
        folder / "scan.csv",
        "wavelength_nm angle_deg time_s exposure_us signal_dn signal_dn_std dark_dn dark_dn_std",
        scan,
    )
    header = "when angle_deg wavelength_nm time_s current_a current_a_std"
    write(folder / "reference.csv", header, reference)
    certificate = list(zip(WAVELENGTH_NM, responsivity, 0.004 * responsivity, strict=True))
    header = "wavelength_nm responsivity_a_per_w responsivity_a_per_w_std"
    write(folder / "photodiode.csv", header, certificate)


def tungsten_lamps(path: Path, n_lamps: int = 6) -> None:
    """Write spectra of filaments at slightly different temperatures, W m-2 sr-1 nm-1."""
    wavelength_nm = np.arange(700.0, 1001.0, 5.0)
    kelvin = 2900 + 15.0 * np.arange(n_lamps)
    planck = 1.191e29 / wavelength_nm**5 / np.expm1(1.4388e7 / np.outer(kelvin, wavelength_nm))
    radiance = 0.11 * planck / planck[0, len(wavelength_nm) // 2]
    names = " ".join(f"lamp_{k + 1}" for k in range(n_lamps))
    write(path, f"wavelength_nm {names}", np.column_stack([wavelength_nm, radiance.T]).tolist())


def draw_lamp(axes: Axes, spectra: LampSpectra, wavelength_nm: Numbers) -> None:
    """Show a lamp's spectrum beside the response."""
    shape = np.interp(wavelength_nm, spectra.wavelength_nm, spectra.radiance[0])
    label = "spectrum of lamp 1, relative"
    axes.plot(wavelength_nm, shape / shape.max(), color=ORANGE, label=label)
    axes.set(title="(a) relative spectral response")
    axes.legend(loc="upper left", ncols=3, columnspacing=1.0)


def draw_expected_shift(axes: Axes) -> None:
    """Show what an interference filter does."""
    fine = np.linspace(-4.5, 4.5, 91)
    expected = -835 * (np.sin(np.deg2rad(fine)) / 2.0) ** 2 / 2
    axes.plot(fine, expected, color=GREY, linewidth=1, label="filter of index 2")
    axes.set(title="(b) shift of the centroid, ± 2 std")
    axes.set_xlim(-5, 6.5)
    axes.legend(loc="lower center")


def draw_levels(axes: Axes, spectra: LampSpectra, response: SpectralResponse) -> None:
    """Show the sphere's radiance in the band by the number of lamps."""
    levels = band_radiance(spectra, response, correlation_length_nm=30.0).by_level()
    value = [figure.value for figure in levels.values()]
    axes.errorbar(
        list(levels), value, [2 * figure.std for figure in levels.values()], fmt="o", capsize=3
    )
    axes.set(title="(c) radiance by level, ± 2 std", xlabel="lamps", ylabel="W m⁻² sr⁻¹")
    axes.set(xlim=(0, len(value) + 1), ylim=(0, 1.15 * max(value)))


def draw(scan: SpectralScan, spectra: LampSpectra) -> Figure:
    """Return the figure."""
    figure = new_figure(11.0, 3.6)
    response, shifts, levels = figure.subplots(1, 3, width_ratios=[1.7, 1, 1])
    draw_response(response, scan.at_angle(0.0), 0.0)
    draw_lamp(response, spectra, scan.wavelength_nm)
    draw_shifts(shifts, angular_variation(scan))
    draw_expected_shift(shifts)
    draw_levels(levels, spectra, scan.at_angle(0.0))
    return figure


def main() -> None:
    """Reduce a scan, or a simulated one, and draw it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scan", type=Path)
    parser.add_argument("--lamps", type=Path)
    parser.add_argument("--certificate-relative-std", type=float, default=0.01)
    parser.add_argument("--out", type=Path, default=Path("docs/gallery"))
    options = parser.parse_args()
    with TemporaryDirectory() as temporary:
        folder = options.scan or Path(temporary)
        if options.scan is None:
            simulate_scan(folder, default_rng(2010))
        lamps = options.lamps or Path(temporary) / "lamps.csv"
        if options.lamps is None:
            tungsten_lamps(lamps)
        scan = SpectralScan.load(folder)
        spectra = LampSpectra.load(lamps, certificate_relative_std=options.certificate_relative_std)
    options.out.mkdir(parents=True, exist_ok=True)
    path = options.out / "spectral-response.png"
    with house_style():
        draw(scan, spectra).savefig(path)
    print(path)


if __name__ == "__main__":
    main()
