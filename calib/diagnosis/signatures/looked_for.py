"""Which effects are looked for in a recording, and why the others are not."""

from collections.abc import Callable, Sequence

import numpy as np

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.recorded.limits import too_few_frames
from calib.diagnosis.shapes.dark_rates import dark_rate_shapes
from calib.diagnosis.shapes.grids import Scales
from calib.diagnosis.shapes.of_effects import departures, shapes_of
from calib.diagnosis.shapes.told_shapes import told_shapes
from calib.diagnosis.signatures.all_signatures import all_signatures
from calib.diagnosis.signatures.code_credit import with_code_credit
from calib.diagnosis.signatures.signature import Signature
from calib.diagnosis.simulation.response import Responder

Progress = Callable[[float], None]


def scales_of(evidence: Evidence, responder: Responder) -> Scales:
    """Return the sizes of the recording."""
    table = evidence.table
    period_s = table.line_period_us * 1e-6
    return Scales(
        evidence.sensor.camera,
        float(table.started_s[-1] - table.started_s[0]) or 1.0,
        period_s,
        responder.chain.most_electrons,
        float(table.radiance.max()),
        tuple(
            f for peak in evidence.peaks if peak.stands_out for f in peak.frequencies_hz(period_s)
        ),
        int(np.median(table.n_lines)),
    )


def not_testable(evidence: Evidence) -> dict[str, str]:
    """Return what the plan lacks to show effects at all, by their names."""
    blocks, camera = evidence.table.blocks, evidence.sensor.camera
    lacks = {
        kind.name: kind.why_not_testable(blocks, camera) or too_few_frames(kind, evidence.n)
        for kind in departures()
    }
    return {name: lack for name, lack in lacks.items() if lack is not None}


def not_visible(evidence: Evidence, signatures: Sequence[Signature]) -> dict[str, str]:
    """Return effects whose signature the baseline absorbs, though the plan has what they need."""
    seen, lacking = {s.shape.name for s in signatures}, not_testable(evidence)
    text = "the fitted offsets, slopes and noise of this plan absorb it"
    return {k.name: text for k in departures() if k.name not in seen and k.name not in lacking}


def signatures_of(
    evidence: Evidence, responder: Responder, *, progress: Progress = lambda _: None
) -> tuple[Signature, ...]:
    """Return the signatures of all effects that this recording could show."""
    scales, lacking = scales_of(evidence, responder), not_testable(evidence)
    kinds = [kind for kind in departures() if kind.name not in lacking]
    told = told_shapes(evidence)
    shapes = [
        told[k.name] if k.name in told else shapes_of(k, scales) + dark_rate_shapes(k, evidence)
        for k in kinds
    ]
    return with_code_credit(all_signatures(shapes, evidence, responder, progress), evidence)
