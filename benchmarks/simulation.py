"""Shot noise, read noise and the converter, drawn for a 12-bit frame on one thread."""

import numpy as np

from benchmarks.limits import bare_normal_codes
from benchmarks.peer import race_with_peers
from benchmarks.race import race
from benchmarks.row import Row
from benchmarks.size import Size
from calib.kernels.noise import draw_codes

MEAN_E, READ_NOISE_E, GAIN_DN_PER_E = 8000.0, 10.0, 0.2
TO_REACH_MPIX_S = 500.0


def run(size: Size) -> Row:
    """Draw frames; the limit is the generator and nothing else."""
    rng = np.random.default_rng(1)
    shape = (size.n_lines, size.n_columns)
    ones, lines = np.ones(size.n_columns), np.ones(size.n_lines)
    bare = np.empty(shape, np.uint16)

    def ours() -> None:
        draw_codes(
            MEAN_E * ones[None],
            lines,
            0 * ones,
            read_std_e=READ_NOISE_E,
            gain_dn_per_e=GAIN_DN_PER_E * ones,
            offset_dn=0 * ones,
            full_scale_dn=4095,
            full_well_e=40_000.0,
            key=int(rng.integers(1 << 63)),
        )

    def with_numpy() -> None:
        electrons = rng.poisson(MEAN_E, shape) + READ_NOISE_E * rng.standard_normal(shape)
        np.clip(np.rint(electrons * GAIN_DN_PER_E), 0, 4095).astype(np.uint16)

    mpix = size.frame_pixels / 1e6
    figures = race(
        mpix,
        {
            "ours": ours,
            "numpy": with_numpy,
            "limit": lambda: bare_normal_codes(bare, np.uint32(3), np.uint32(5)),
        },
        rounds=size.rounds,
    )
    return Row(
        work=f"simulate shot + read noise + ADC, {size.frame}, 12 bit, one thread",
        unit="Mpix/s",
        ours=figures["ours"].rate,
        numpy=figures["numpy"],
        peers=race_with_peers(
            size, mpix, ours, {"Pyxel": "simulate-pyxel", "emva1288": "simulate-emva1288"}
        ),
        limit=figures["limit"],
        limit_is="its counter-based generator alone",
        bound=f">= {TO_REACH_MPIX_S:.0f} Mpix/s per core",
        reached=figures["ours"].rate >= TO_REACH_MPIX_S,
    )
