"""What widths of codes change in the histogram of all codes, from the chance of each code."""

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline.expected_codes import between_edges, in_steps, own_means_hidden
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.simulation.chain_run import FittedChain
from calib.diagnosis.simulation.coded_means import moved_by_codes
from calib.forward.effects.adc_dnl import AdcDnl

Floats = NDArray[np.float64]


def change_by_widths(dnl: AdcDnl, chain: FittedChain, evidence: Evidence) -> Floats:
    """Return the change of code shares about what pixels' own means lead to expect, (n_codes,).

    Few drawn lines would tell a width to the square root of the samples in its code. Own means hold
    by what the widths move them.

    Args:
        dnl: The widths.
        chain: Of the links.
        evidence: The recording's.
    """
    base, counts = evidence.baseline, evidence.code_counts
    shape, hidden = base.mean_dn.shape, own_means_hidden(base)
    moved = moved_by_codes(chain, (dnl,), np.zeros((shape[0], base.mean_dn[0].size)))
    n_codes, together = len(counts.expected), dict[int, Floats]()
    for b in counts.of_blocks:
        each, noise = evidence.sums[b], base.variance_dn2[b]
        noise = noise + evidence.common.shared_dn2(float(evidence.signal_dn[b]))
        about = base.mean_dn[b] if hidden[b] else each.mean_dn - moved[b].reshape(shape[1:])
        fine, steps = in_steps(about, noise, each.n_lines, n_codes)
        together[fine] = together.get(fine, 0.0) + steps
    edges = np.concatenate([[0.0], np.cumsum(dnl.widths())]) - 0.5
    found = sum(between_edges(steps, fine, edges) for fine, steps in together.items())
    return np.asarray((found - counts.expected) / max(counts.samples, 1.0))
