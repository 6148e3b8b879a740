"""What faults of codes change in the histogram of all codes."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline.expected_codes import about_means, own_means_hidden
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.simulation.fault_surroundings import LEAST_DN2, Surroundings
from calib.forward.code_fault import CodeFault

Floats = NDArray[np.float64]


def change_of_codes(
    faults: Sequence[CodeFault], moved: Floats, added: Floats, surroundings: Surroundings
) -> Floats:
    """Return the change of code shares about what pixels' own means lead to expect, (n_codes,).

    Own means hold what all effects do to them, those that are not found yet as well: where the
    codes stood before the faults, they lie by that off from here by which faults move them.

    Args:
        faults: In the order in which they act.
        moved: By what they move means, DN, (n_blocks, n_rows, n_columns).
        added: What they add to variances, DN^2, likewise.
        surroundings: What they act on.
    """
    evidence = surroundings.evidence
    sensor, counts = evidence.sensor, evidence.code_counts
    hidden, n_codes = own_means_hidden(evidence.baseline), surroundings.n_codes
    together = [(*each, np.zeros(n_codes)) for each in _together(faults, sensor)]
    found = np.zeros(n_codes)
    for b, expected in counts.of_blocks.items():
        if not surroundings.touched_by(faults, b):
            continue
        n, about = float(evidence.n[b]), surroundings.means[b]
        shared = evidence.common.shared_dn2(float(evidence.signal_dn[b]))
        noise = surroundings.variance[b] + shared
        if hidden[b]:
            # Means are known there, and samples scatter about them by all of their noise.
            noise = noise + (noise - 1.0 / 12.0) / max(n - 1.0, 1.0)
        else:
            # About own means they scatter less, by what these scatter; jumps move them, too.
            about = evidence.sums[b].mean_dn - moved[b]
            noise = np.maximum(noise - added[b] / n, LEAST_DN2)
        for of_tap, _, before in together:
            before[:] += about_means(about[of_tap], noise[of_tap], n, n_codes)
        found -= expected
    found += sum(_mapped(before, acting) for _, acting, before in together)
    return found / max(counts.samples, 1.0)


def _together(
    faults: Sequence[CodeFault], sensor: Sensor
) -> Iterator[tuple[NDArray[np.bool_], list[CodeFault]]]:
    """Yield pixels, (n_rows, n_columns), that have the same faults, and which these are."""
    if all(fault.only_tap is None for fault in faults):
        yield np.ones(sensor.tap.shape, bool), list(faults)
        return
    for tap in range(sensor.n_taps):
        yield sensor.tap == tap, [fault for fault in faults if fault.acts_on(tap)]


def _mapped(samples: Floats, faults: Sequence[CodeFault]) -> Floats:
    """Return the samples by code after the faults, (n_codes,)."""
    every = np.arange(len(samples), dtype=np.float64)
    for fault in faults:
        to = np.clip(fault.faulty(every), 0, len(samples) - 1).astype(np.intp)
        moved = np.bincount(to, samples, minlength=len(samples))
        samples = (1.0 - fault.chance) * samples + fault.chance * moved
    return samples
