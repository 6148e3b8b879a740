"""Raw codes to radiance and flags, without and with the standard uncertainty."""

import numpy as np

from benchmarks.example_set import example_set
from benchmarks.limits import copying
from benchmarks.peer import race_with_peers
from benchmarks.race import race
from benchmarks.row import Row
from benchmarks.size import Size
from calib.kernels.radiance import aligned
from calib.radiometric.correction.apply import Correction
from calib.radiometric.correction.radiance_lines import Radiance

STRETCH_BYTES = 1 << 21  # of radiance: what `correct_recording` takes at once
LEAST_SHARE, LEAST_SHARE_WITH_STD = 0.6, 0.4


def without_std(size: Size) -> Row:
    """Radiance and flags: 2 bytes are read and 5 written for a pixel."""
    return _row(size, std=False, n_bytes=7, least=LEAST_SHARE)


def with_std(size: Size) -> Row:
    """Radiance, standard uncertainty and flags: 2 bytes are read and 9 written for a pixel."""
    return _row(size, std=True, n_bytes=11, least=LEAST_SHARE_WITH_STD)


def _row(size: Size, *, std: bool, n_bytes: int, least: float) -> Row:
    dn = aligned((size.n_lines, size.n_columns), np.uint16)
    dn[:] = np.random.default_rng(1).integers(0, 4096, dn.shape)
    coefficients = example_set(size.n_columns)
    correction = Correction(coefficients, 200.0, camera=coefficients.camera)
    out = Radiance.empty(*dn.shape, std=std)
    n_lines = min(len(dn), STRETCH_BYTES // (4 * dn.shape[1]))
    sizes = {min(n_lines, len(dn) - first) for first in range(0, len(dn), n_lines)}
    short = {n: Radiance.empty(n, dn.shape[1], std=std) for n in sizes}
    dark = correction.terms.dark_dn.astype(np.float32)
    scale = correction.terms.scale.astype(np.float32)

    def whole() -> None:
        correction.lines(dn, out=out)

    def ours() -> None:
        for first in range(0, len(dn), n_lines):
            stretch = dn[first : first + n_lines]
            correction.lines(stretch, out=short[len(stretch)])

    def with_numpy() -> None:
        signal = dn - dark
        if std:
            np.sqrt(correction.terms.noise_dn2 + np.maximum(signal, 0)) * scale
        _ = signal * scale, (dn >= 4095) | (signal < 0)

    moved = size.frame_pixels * n_bytes
    figures = race(
        moved / 1e6,
        {
            "ours": ours,
            "whole": whole,
            "numpy": with_numpy,
            "limit": copying(moved),
        },
        rounds=size.rounds,
    )
    share = figures["limit"].ours_is
    at_once = share / figures["whole"].ours_is
    jobs = {} if std else {"ccdproc": "correct-ccdproc"}
    return Row(
        work=f"apply, u16 {size.frame} to f32 radiance{', uncertainty' if std else ''} and flags, "
        "one thread",
        unit="MB/s moved",
        ours=figures["ours"].rate,
        numpy=figures["numpy"],
        peers=race_with_peers(size, moved / 1e6, ours, jobs),
        limit=figures["limit"],
        limit_is="copying as many bytes",
        bound=f">= {100 * least:.0f} % of the copy rate",
        reached=share >= least,
        notes=(
            f"{100 * share:.0f} % of the copy rate",
            f"in stretches of {n_lines} lines into the same arrays, as a recording is corrected; "
            f"{100 * at_once:.0f} % where a whole frame goes to arrays of its own",
        ),
    )
