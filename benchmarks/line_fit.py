"""A straight line against exposure in every column, five exposures."""

import numpy as np

from benchmarks.limits import bare_combination
from benchmarks.race import race
from benchmarks.row import Row
from benchmarks.size import Size
from calib.kernels.column_fit import fit_lines
from calib.kernels.radiance import aligned

EXPOSURES_US = np.array([100.0, 200.0, 300.0, 400.0, 500.0])
TO_REACH_MB_S = 15_000.0


def run(size: Size) -> Row:
    """Fit on one thread with shared weights; MB are those of the means that are read."""
    shape = (len(EXPOSURES_US), size.fit_pixels)
    means = aligned(shape, np.float32)
    means[:] = np.random.default_rng(1).uniform(10, 4000, shape)
    fitted, bare = (aligned((2, size.fit_pixels), np.float32) for _ in range(2))
    centred = EXPOSURES_US - EXPOSURES_US.mean()

    def with_einsum() -> None:
        slope = np.einsum("k,kn->n", (centred / (centred @ centred)).astype(np.float32), means)
        np.einsum("k,kn->n", np.full(len(means), 1 / len(means), np.float32), means) - (
            np.float32(EXPOSURES_US.mean()) * slope
        )

    mbytes = means.nbytes / 1e6
    ours = lambda: fit_lines(means, None, EXPOSURES_US, out=fitted)  # noqa: E731
    figures = race(
        mbytes,
        {
            "ours": ours,
            "numpy": with_einsum,
            "limit": lambda: bare_combination(means, *bare),
        },
        rounds=size.rounds,
    )
    polyfit = race(
        mbytes,
        {"ours": ours, "np.polyfit": lambda: np.polyfit(EXPOSURES_US, means, 1)},
        rounds=3,
    )
    return Row(
        work=f"line fit per column, 5 exposures x {size.fit_pixels / 1e6:.1f} Mpix, one thread",
        unit="MB/s",
        ours=figures["ours"].rate,
        numpy=figures["numpy"],
        peers={"np.polyfit": polyfit["np.polyfit"]},
        limit=figures["limit"],
        limit_is="a bare loop that reads the same and writes the same",
        bound=f">= {TO_REACH_MB_S:.0f} MB/s",
        reached=figures["ours"].rate >= TO_REACH_MB_S,
    )
