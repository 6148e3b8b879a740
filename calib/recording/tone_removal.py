"""Taking a tone out of sums, exactly as if it had been taken out of the samples.

A frame's samples are x[j, i] = m[i] + Re(c·w[j]·p[i]) + noise, with w[j] = exp(2πi·f_l·j),
p[i] = exp(2πi·f_p·i); f_l and f_p are the tone's cycles per line and per pixel clock. The column's
mean m[i] is free, so that the fixed pattern does not pull on the tone. With g[j, i] =
(w[j] − mean w)·p[i], G = Σ|g|², H = Σg² and Y = Σx·conj(g), least squares over the frame gives

    c = 2·(G·Y − conj(H)·conj(Y)) / (G² − |H|²).

Y needs the lines only through each column's demodulated sum D = Σ x·conj(w) and plain sum S. With
b = Re(c·w·p) the sums over any set of lines become, by column,

    Σ b = Re(c·p·Σw),   Σ x·b = Re(c·p·conj(D)),   Σ b² = (n·|c|² + Re(c²·p²·Σw²)) / 2,

and Σ(x − b) and Σ(x − b)² follow.
"""

from dataclasses import dataclass

import numpy as np

from calib.arrays import Columns, RawLines
from calib.errors import InputError, NotDeterminedError
from calib.kernels.demodulation import Phasors, demodulated
from calib.kernels.line_sums import LineSums
from calib.recording.tone import Tone

# Below this share of a tone's power between its lines it is all but a part of the offset.
_LEAST_POWER = 0.01


@dataclass(frozen=True)
class ToneSums:
    """Σ b, Σ x·b and Σ b² over a set of lines, each (n_columns,); b is the tone in DN."""

    tone: Columns
    product: Columns
    power: Columns

    @classmethod
    def zero(cls, n_columns: int) -> "ToneSums":
        """Return the sums over no lines."""
        return cls(*(np.zeros(n_columns) for _ in range(3)))

    def __add__(self, other: "ToneSums") -> "ToneSums":
        """Return the sums over the lines of both."""
        return ToneSums(
            self.tone + other.tone, self.product + other.product, self.power + other.power
        )

    def __sub__(self, part: "ToneSums") -> "ToneSums":
        """Return the sums over the lines that are not in `part`."""
        return ToneSums(self.tone - part.tone, self.product - part.product, self.power - part.power)


def tone_amplitude(dn: RawLines, tone: Tone) -> complex:
    """Return c of one frame of consecutive lines, DN; |c| is the amplitude."""
    return _amplitude(dn, tone, demodulated(dn, _along_lines(dn, tone)))


def tone_sums(dn: RawLines, tone: Tone, part: slice) -> tuple[ToneSums, ToneSums]:
    """Estimate the tone on one frame; return its sums over all lines, and over those of `part`."""
    w = _along_lines(dn, tone)
    every = demodulated(dn, w)
    at_column = _amplitude(dn, tone, every) * _phasors(dn.shape[1], tone.cycles_per_pixel)
    of_part = demodulated(dn, w, first=part.start, step=part.step)
    return _sums_of(at_column, w, every), _sums_of(at_column, w[part], of_part)


def without_tone(sums: LineSums, tone: ToneSums) -> tuple[Columns, Columns]:
    """Return mean (DN) and unbiased variance (DN²) of the samples less the tone."""
    n = sums.n_lines
    mean = (sums.codes - tone.tone) / n
    if n < 2:
        return mean, np.full(len(mean), np.nan)
    # About an integer next to the mean, where all sums are small and the integer ones exact.
    about = (sums.codes + np.uint64(n // 2)) // np.uint64(n)
    count = np.uint64(n)
    squares = (sums.squares - 2 * about * sums.codes + count * about * about).astype(np.float64)
    rest = (sums.codes - count * about).view(np.int64) - tone.tone
    squares += tone.power - 2 * (tone.product - about * tone.tone)
    return mean, (squares - rest**2 / n) / (n - 1)


def _along_lines(dn: RawLines, tone: Tone) -> Phasors:
    return _phasors(len(dn), tone.cycles_per_line)


def _phasors(n: int, cycles: float) -> Phasors:
    # Whole cycles are dropped before they can eat the phase's digits.
    turns = np.remainder(np.arange(n) * np.remainder(cycles, 1.0), 1.0)
    phasors: Phasors = np.exp(2j * np.pi * turns)
    return phasors


def _amplitude(dn: RawLines, tone: Tone, demodulated_columns: Phasors) -> complex:
    w = _along_lines(dn, tone)
    p = _phasors(dn.shape[1], tone.cycles_per_pixel)
    between = w - w.mean()
    power = dn.shape[1] * float(np.sum(np.abs(between) ** 2))
    squares = complex(np.sum(p**2) * np.sum(between**2))
    determinant = power**2 - abs(squares) ** 2
    if power < _LEAST_POWER * dn.size or determinant < _LEAST_POWER * power**2:
        raise NotDeterminedError(
            f"a tone of {tone.cycles_per_line:g} cycles per line cannot be told from the columns' "
            f"offsets in a frame of {len(dn)} lines: leave it in (it is a part of the offset), or "
            "record longer frames",
            code="tone-not-determined",
        )
    codes = dn.sum(axis=0, dtype=np.uint64)
    projected = complex(np.sum(np.conj(p) * (demodulated_columns - np.conj(w.mean()) * codes)))
    amplitude: complex = 2 * (power * projected - (squares * projected).conjugate()) / determinant
    return amplitude


def _sums_of(at_column: Phasors, w: Phasors, demodulated_lines: Phasors) -> ToneSums:
    return ToneSums(
        tone=np.real(at_column * w.sum()),
        product=np.real(at_column * np.conj(demodulated_lines)),
        power=(len(w) * np.abs(at_column) ** 2 + np.real(at_column**2 * np.sum(w**2))) / 2,
    )


def check_tone(tone: Tone, rows: int | None) -> None:
    """Raise InputError where a tone is to be removed from an area sensor's frames."""
    if rows is not None:
        raise InputError(
            f"a tone ({tone.cycles_per_pixel:g} cycles per pixel) is removed from lines, not from "
            "an area sensor's frames: leave it out",
            code="tone-needs-lines",
        )
