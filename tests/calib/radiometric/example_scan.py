"""A simulated monochromator scan with known truth, written as the folder that is read."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.random import Generator

ANGLES_DEG = (-4.0, -2.0, 0.0, 2.0, 4.0)
WAVELENGTH_NM = np.arange(750.0, 921.0, 3.0)


def true_response(wavelength_nm: np.ndarray, shift_nm: float = 0.0) -> np.ndarray:
    """A NIR band, 780 to 890 nm at half maximum, peak 1 to 1e-6."""
    edges = 1 / (1 + np.exp(-(wavelength_nm - shift_nm - 780) / 3))
    return edges / (1 + np.exp((wavelength_nm - shift_nm - 890) / 3))


@dataclass(frozen=True)
class ExampleScan:
    """How the bench errs; all shares are relative."""

    noise_dn: float = 1.0
    reading_noise: float = 1e-3
    drift: float = 0.02
    drift_known: bool = True
    photodiode_std: float = 5e-3
    shift_nm_at_4_deg: float = 0.0
    angles_deg: tuple[float, ...] = ANGLES_DEG

    def write(self, folder: Path, rng: Generator) -> Path:
        """Write scan.csv, reference.csv and photodiode.csv."""
        folder.mkdir(exist_ok=True)
        responsivity = 0.3 + 0.001 * (WAVELENGTH_NM - 700)
        scan, reference = [], []
        for number, angle in enumerate(self.angles_deg):
            lamp = 1e-6 * (1 + 0.3 * np.sin(WAVELENGTH_NM / 20))
            drift = self.drift * rng.uniform(-1, 1)
            share = 0.5 if self.drift_known else rng.uniform()
            shift = self.shift_nm_at_4_deg * (angle / 4) ** 2
            signal = 2e9 * lamp * (1 + share * drift) * true_response(WAVELENGTH_NM, shift)
            signal = (1 - 0.01 * abs(angle)) * signal + 30 + self._noise(rng)
            dark = 30 + self._noise(rng)
            current = lamp * responsivity
            start = 1000.0 * number
            scan += [
                f"{w},{angle},{start + 500},200,{s!r},{self.noise_dn},{d!r},{self.noise_dn}"
                for w, s, d in zip(WAVELENGTH_NM, signal.tolist(), dark.tolist(), strict=True)
            ]
            for when, time_s, factor in (("before", 0.0, 1.0), ("after", 1000.0, 1 + drift)):
                std = self.reading_noise * current
                read = current * factor + std * rng.normal(size=len(current))
                reference += [
                    f"{when},{angle},{w},{start + time_s},{i + 1e-12!r},{u!r},1e-12"
                    for w, i, u in zip(WAVELENGTH_NM, read.tolist(), std.tolist(), strict=True)
                ]
        certified = responsivity * (1 + self.photodiode_std * rng.normal(size=len(responsivity)))
        photodiode = [
            f"{w},{s!r},{self.photodiode_std * s!r}"
            for w, s in zip(WAVELENGTH_NM, certified.tolist(), strict=True)
        ]
        write_csv(
            folder / "scan.csv",
            "wavelength_nm,angle_deg,time_s,exposure_us,signal_dn,signal_dn_std,dark_dn,dark_dn_std",
            scan,
        )
        write_csv(
            folder / "reference.csv",
            "when,angle_deg,wavelength_nm,time_s,current_a,current_a_std,dark_current_a",
            reference,
        )
        write_csv(
            folder / "photodiode.csv",
            "wavelength_nm,responsivity_a_per_w,responsivity_a_per_w_std",
            photodiode,
        )
        return folder

    def _noise(self, rng: Generator) -> np.ndarray:
        return self.noise_dn * rng.normal(size=len(WAVELENGTH_NM))


def write_csv(path: Path, header: str, rows: list[str]) -> Path:
    """Write a table and return its path."""
    path.write_text("\n".join([header, *rows]) + "\n")
    return path
