"""What the diagnosis says of real recordings: tables to standard output, figures into a folder.

    python -m examples.real_recordings [--out docs/gallery] [--real FOLDER]

A 12-bit CCD of which sums survive, a CCD of four taps (frames of the package msfc-ccd), flats and
darks of an X-ray camera, and LSST's covariances of flats; what is not there is left out. --real
names the folder that holds emva1288_ccd12, xray_flats_darks and lsst_bf_covariances.
"""

import argparse
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from matplotlib.figure import Figure

from calib.diagnosis.answer.diagnosis import Diagnosis
from calib.diagnosis.diagnose import diagnose
from calib.diagnosis.sums.diagnose import diagnose_sums
from calib.recording.folder_recording import FolderRecording
from calib.report.style import house_style
from examples.photon_transfer import folder_of_sums, sample_files
from examples.real.figures import before_and_after, shared_noise, step_and_neighbours
from examples.real.folders import folder_of_taps, folder_of_xray, frame_of, taps_of
from examples.real.numbers import dark_growth, dark_pair, deferred, lsst_covariances, spectrum

REAL = Path(__file__).resolve().parents[2] / "shared" / "data" / "real"


def main() -> None:
    """Diagnose, draw and print what there is data for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("docs/gallery"))
    parser.add_argument("--real", type=Path, default=REAL)
    chosen = parser.parse_args()
    chosen.out.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory() as scratch, house_style():
        for name, figure in figures(chosen.real, Path(scratch)):
            figure.savefig(chosen.out / f"real-{name}.png")


def figures(real: Path, scratch: Path) -> Iterator[tuple[str, Figure]]:
    """Yield the figures by name."""
    table = real / "emva1288_ccd12" / "ptc_table.csv"
    if table.exists():
        sums = diagnose_sums(FolderRecording(folder_of_sums(table, scratch / "ccd12")))
        print_diagnosis("12-bit CCD, sums", sums.diagnosis)
        yield "ccd12", before_and_after(sums)
    if (files := sample_files()) is not None:
        taps = diagnose(FolderRecording(folder_of_taps(files, scratch / "taps"))).diagnosis
        print_diagnosis("CCD of four taps", taps)
        print_taps(files.parent)
        yield "taps", shared_noise(files)
    tooth = real / "xray_flats_darks" / "tooth.h5"
    if tooth.exists():
        xray = diagnose(FolderRecording(folder_of_xray(tooth, scratch / "xray"))).diagnosis
        print_diagnosis("X-ray flats and darks", xray)
        yield "xray", step_and_neighbours(tooth)
    lsst = real / "lsst_bf_covariances"
    if lsst.exists():
        print_lsst(lsst)


def print_diagnosis(name: str, found: Diagnosis) -> None:
    """Print what was missed, what it was called, and deviances of blocks left out."""
    print(f"\n## {name}\n\nverdict: {found.verdict}")
    before, after = found.baseline, found.final
    print(f"held-out deviance: {before.heldout_deviance:.1f} -> {after.heldout_deviance:.1f}")
    print(f"numbers predicted: {after.dof}")
    for each in found.findings:
        names = ", ".join(f"{c.effect} {c.probability:.2f}" for c in each.candidates)
        values = ", ".join(
            f"{n} = {e.value:.3g} ± {e.std:.1g} {e.unit}" for n, e in each.parameters.items()
        )
        print(f"- {each.effect.name} ({names}): {each.significance_sigma:.1f} σ; {values}")
        print(f"  {each.where.text}")
        print(f"  without it {each.heldout_before:.1f}, with it {each.heldout_after:.1f}")
    if found.unexplained is not None:
        print(f"- unexplained, {found.unexplained.significance_sigma:.1f} σ:")
        print(f"  {found.unexplained.where.text}")
    for remark in found.remarks:
        print(f"- {remark}")
    print(f"not testable: {len(found.not_testable)} effects")


def print_taps(data: Path) -> None:
    """Print what each tap's own pixels say, all of them: offsets, noise, deferred charge."""
    noise = dark_pair(data / "led")
    shared = np.corrcoef([n.ravel() for n in noise])
    dark = [np.median(t) for t in taps_of(frame_of(data / "led", 4860))]
    rows = [float(n.mean(axis=1).var() - n.var() / n.shape[1]) for n in noise]
    print("\n| tap | offset, DN | noise, DN | correlation with tap 0 | rows, DN² | EPER | CTI |")
    print("|---|---|---|---|---|---|---|")
    for k, (share, cti) in enumerate(deferred(data / "led")):
        print(
            f"| {k} | {dark[k]:.0f} | {noise[k].std():.2f} | {shared[0, k]:.3f} | {rows[k]:+.3f} "
            f"| {share:.2e} | {cti:.1e} |"
        )
    power = spectrum(noise[0])
    share = 2 * np.sort(power)[::-1] / len(noise[0].ravel()) / noise[0].var()
    print(f"\ntones of tap 0: strongest {np.argmax(power) / noise[0].size:.5f} cycles a pixel")
    print(f"its share of the noise's variance {share[0]:.3f}, of the 1000 strongest bins "
          f"{share[:1000].sum():.3f}")  # fmt: skip
    growth = dark_growth(data / "dark_current")
    print("dark signal, 12 s less 2 s, DN: " + ", ".join(f"{g:+.3f}" for g in growth))


def print_lsst(folder: Path) -> None:
    """Print LSST's nearest covariances, what they lose beyond the nearest, and their sum."""
    print("\n## LSST\n\n| sensor | row, 1/e⁻ | column | corner | beyond the eight | sum / a00 |")
    print("|---|---|---|---|---|---|")
    for sensor in ("e2v", "itl"):
        cov = lsst_covariances(folder / f"{sensor}_covariances_21oct19.txt")
        twice = np.where(np.arange(len(cov)) > 0, 2.0, 1.0)
        every = np.outer(twice, twice) * cov
        near = every[:2, :2].sum() - cov[0, 0]
        beyond = 1.0 + near / cov[0, 0]
        print(
            f"| {sensor} | {cov[1, 0]:.3g} | {cov[0, 1]:.3g} | {cov[1, 1]:.3g} "
            f"| {100 * beyond:.0f} % | {100 * every.sum() / cov[0, 0]:+.2f} % |"
        )


if __name__ == "__main__":
    main()
