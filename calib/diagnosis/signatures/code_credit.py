"""Errors of codes that differ code by code: what the counts of single codes say of them.

Whitened numbers say how rough a histogram is, not which codes are often: of a comb of four codes
and of two, both as rough, they see half of the difference, and of a weak comb next to nothing. So
each such shape is credited with what the likelihood of the counts says of it, less what these
numbers do.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.signatures.signature import Signature
from calib.diagnosis.signatures.template_error import temper
from calib.forward.effects.adc_dnl import AdcDnl
from calib.forward.effects.stuck_bit import StuckBit

Floats = NDArray[np.float64]

LOW_BITS = 4
"""Bits from here on move samples to where hardly any are, which other numbers count."""
MOST = 100.0
"""Deviance that the likeliest has by that at the most: what is expected is right but nearly."""


def with_code_credit(
    signatures: Sequence[Signature], evidence: Evidence, told: Floats | None = None
) -> tuple[Signature, ...]:
    """Return the signatures, those of low bits and of widths credited with what counts say.

    Args:
        signatures: Of all shapes that compete.
        evidence: The recording's.
        told: Change of code shares by what is found already, (n_codes,), which is no one else's.
    """
    left, counted = evidence.code_counts.residual()[0], 1.0
    if told is not None:
        # What is left beside that scatters by what it may err by, too.
        counts = evidence.code_counts
        left, counted = left - told, temper(counts.likelihood.worth(told * counts.samples))
    gains = {
        k: counted * _gain(each, left, evidence)
        for k, each in enumerate(signatures)
        if _is_told_code_by_code(each)
    }
    # What was fitted explains as much by chance as there are numbers; twice that is its own price.
    net = {k: gain - 2.0 * signatures[k].shape.freedom for k, gain in gains.items()}
    numbers = {k: _of_numbers(signatures[k], left, evidence) for k in gains}
    best = max(net, key=lambda k: net[k], default=None)
    beyond = 0.0 if best is None else max(net[best] - numbers[best] - MOST, 0.0)
    found = list(signatures)
    for k, gain in gains.items():
        credit = gain - numbers[k] - beyond
        found[k] = replace(found[k], shape=replace(found[k].shape, of_codes=credit))
    return tuple(found)


def _is_told_code_by_code(each: Signature) -> bool:
    template = each.shape.template
    return isinstance(template, AdcDnl) or (
        isinstance(template, StuckBit) and template.bit < LOW_BITS
    )


def _gain(each: Signature, left: Floats, evidence: Evidence) -> float:
    """Return what a shape explains of counts whose shares are off by `left`, (n_codes,)."""
    counts, template = evidence.code_counts, each.shape.template
    seen = left * counts.samples
    if isinstance(template, AdcDnl) and not template.widths_dn:
        return counts.likelihood.of_any_widths(seen)
    return counts.likelihood.explained(seen, each.change.codes[0] * counts.samples)


def _of_numbers(each: Signature, left: Floats, evidence: Evidence) -> float:
    """Return what a shape explains of whitened numbers of the same, by as much as there is."""
    told = each.point.rest[evidence.whitening.places["codes"]]
    along = max(float(told @ evidence.code_counts.whitened(left[None])), 0.0)
    return along**2 / max(float(told @ told), 1e-300)
