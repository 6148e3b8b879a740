"""Errors of codes that differ code by code: which of them the histogram itself contradicts.

Whitened numbers say how rough a histogram is, not which codes are often: of a comb of four codes
and of two, both as rough, they see half of the difference. Counts of single codes y and what a
shape foretells of them f, both over the square root of what is expected, part by |y - f|^2. What a
shape explains less of that than the best one does is a price, tempered as all that hangs on shapes.
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


def with_code_credit(signatures: Sequence[Signature], evidence: Evidence) -> tuple[Signature, ...]:
    """Return the signatures, of which those of low bits and of told widths have their price."""
    counts = evidence.code_counts
    observed, told = counts.residual()[0], counts.contrasts.over_std
    gains = {
        k: _gain(told(observed), told(each.change.codes[0]))
        for k, each in enumerate(signatures)
        if _is_told_code_by_code(each)
    }
    # What was fitted explains as much by chance as there are numbers; twice that is its own price.
    most = max((gain - 2.0 * signatures[k].shape.freedom for k, gain in gains.items()), default=0.0)
    found = list(signatures)
    for k, gain in gains.items():
        shape, credit = found[k].shape, min(gain - most, 0.0) * temper(most)
        found[k] = replace(found[k], shape=replace(shape, credit=credit))
    return tuple(found)


def _is_told_code_by_code(each: Signature) -> bool:
    template = each.shape.template
    if isinstance(template, AdcDnl):
        return bool(template.widths_dn)
    return isinstance(template, StuckBit) and template.bit < LOW_BITS


def _gain(seen: Floats, told: Floats) -> float:
    """Return what is explained of the counts, by as much of it as there is."""
    along = max(float(seen @ told), 0.0)
    return along**2 / max(float(told @ told), 1e-300)
