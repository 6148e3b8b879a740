"""Diagnoses a recording: what the plain model lacks, what it is called, how much of it there is."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from calib.diagnosis.answer import known_strengths
from calib.diagnosis.answer.description import describe
from calib.diagnosis.answer.figures import Figures
from calib.diagnosis.answer.findings import (
    Diagnosis,
    Fit,
    Unexplained,
)
from calib.diagnosis.answer.found import findings_of
from calib.diagnosis.baseline.requirements import check_can_be_diagnosed, check_determined
from calib.diagnosis.baseline.scenes import with_steady_light
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.fitted_evidence import evidence_of
from calib.diagnosis.given.given_model import parameters_off
from calib.diagnosis.given.known import beside, known_departures, of_known_baseline
from calib.diagnosis.given.parameter_off import ParameterOff
from calib.diagnosis.given.size import check_size
from calib.diagnosis.naming.all_signatures import all_signatures
from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.grids import Scales
from calib.diagnosis.naming.heldout import HeldOutDeviances
from calib.diagnosis.naming.model import Model
from calib.diagnosis.naming.remainder import CERTAIN_SIGMA, looks_at, worst
from calib.diagnosis.naming.search import as_found, find
from calib.diagnosis.naming.shapes import departures, shapes_of
from calib.diagnosis.naming.signatures import Signature
from calib.diagnosis.naming.told_shapes import told_shapes
from calib.diagnosis.recorded.joint import joint, joint_images
from calib.diagnosis.recorded.limits import limits, too_few_frames
from calib.diagnosis.recorded.scene_light import steady_images
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.simulation.chain_run import FittedChain
from calib.diagnosis.simulation.response import Responder
from calib.diagnosis.statistics.block_sums import BlockSums
from calib.diagnosis.statistics.gather import gather
from calib.diagnosis.statistics.steps import steps
from calib.diagnosis.words.in_words import in_words
from calib.forward.model import Model as ForwardModel
from calib.recording.header import RecordingHeader
from calib.recording.protocol import Recording

BASELINE = (
    "illumination",
    "vignette",
    "responsivity",
    "shot_noise",
    "full_well",
    "read_noise",
    "offset",
    "adc",
)

Progress = Callable[[float], None]


@dataclass(frozen=True)
class Examination:
    """All that a diagnosis rests on: for the answer, an amended model, and figures.

    Attributes:
        evidence: The statistics, and the baseline fitted to them.
        signatures: Of all effects that could have been seen.
        model: The effects found.
        diagnosis: The answer.
    """

    evidence: Evidence
    signatures: tuple[Signature, ...]
    model: Model
    diagnosis: Diagnosis


def diagnose(
    recordings: Recording | Sequence[Recording],
    given: ForwardModel | None = None,
    *,
    progress: Progress = lambda _: None,
) -> Examination:
    """Return what a recording shows beyond the plain model, or beyond `given`; or several of one.

    Raises:
        NotDeterminedError: The recording cannot tell offset, response and noise apart at all.
        InputError: Recordings that are not of one camera at one setting, or at once; a model of
            another size.
    """
    several = recordings if isinstance(recordings, Sequence) else (recordings,)
    if given is not None:
        check_size(given, several[0].header.camera)
    evidence = gathered_evidence(several, progress=lambda done: progress(0.4 * done))
    return examine(evidence, given, progress=lambda done: progress(0.4 + 0.6 * done))


def gathered_evidence(several: Sequence[Recording], *, progress: Progress) -> Evidence:
    """Return the evidence of recordings of one bench together."""
    whole = joint([each.header for each in several])
    check_can_be_diagnosed(whole.header)
    sums: list[BlockSums] = []
    for position, k in enumerate(whole.order):
        sums += gather(several[k], progress=_part(progress, position, len(several)))
    images = joint_images([steady_images(each) for each in several])
    light = with_steady_light(whole, sums, images)
    check_determined(light.sums, light.table)
    return evidence_of(light.sums, light.table, Sensor(whole.header.camera))


def _part(progress: Progress, position: int, of: int) -> Progress:
    """Return what is told the progress of one recording of several."""
    return lambda done: progress((position + done) / of)


def examine(
    evidence: Evidence,
    given: ForwardModel | None = None,
    *,
    progress: Progress = lambda _: None,
) -> Examination:
    """Return the diagnosis of gathered statistics."""
    responder = responder_of(evidence)
    known = known_departures(given, evidence, responder)
    signatures = signatures_of(evidence, responder, progress=progress)
    unknown = [s for s in signatures if known is None or s.shape.name not in known.names]
    contest = Contest(tuple(unknown), evidence, responder)
    model = find(contest, beside(known, evidence))
    contest = as_found(contest, model)
    heldout = HeldOutDeviances(model, evidence)
    findings = findings_of(model, contest, heldout)
    look, sigma = worst(model, evidence)
    unexplained = None
    if sigma > CERTAIN_SIGMA:
        unexplained = Unexplained(sigma, describe(look, model, evidence))
    before, after = heldout.of(()), heldout.of(range(len(model.members)))
    names = tuple(m.signature.shape.name for m in model.members)
    off: tuple[ParameterOff, ...] = ()
    if given is not None:
        off = parameters_off(given, of_known_baseline(known, evidence))
        off += known.off if known is not None else ()
    diagnosis = Diagnosis(
        Fit(BASELINE, before.deviance, before.dof),
        findings,
        Fit((*BASELINE, *names), after.deviance, after.dof),
        unexplained,
        {**not_testable(evidence), **_invisible(evidence, signatures)},
        off,
        _figures(model, evidence),
        remarks=(
            *limits(RecordingHeader(camera=evidence.table.camera, blocks=evidence.table.blocks)),
            *steps(evidence.sums, evidence.table.names, evidence.sensor),
            *known_strengths.remarks(m.effect for m in model.members),
        ),
    )
    return Examination(evidence, signatures, model, in_words(diagnosis, model, evidence))


def responder_of(evidence: Evidence) -> Responder:
    """Return what simulates changes about the fitted baseline."""
    chain = FittedChain(evidence.baseline, evidence.table, evidence.sensor)
    return Responder(chain, evidence.counts, evidence.peaks)


def scales_of(evidence: Evidence, responder: Responder) -> Scales:
    """Return the sizes of the recording."""
    table = evidence.table
    seen = np.flatnonzero(sum(each.histogram for each in evidence.sums))
    period_s = table.line_period_us * 1e-6
    return Scales(
        evidence.sensor.camera,
        float(table.started_s[-1] - table.started_s[0]) or 1.0,
        period_s,
        responder.chain.most_electrons,
        float(table.radiance.max()),
        int(seen[0]),
        tuple(f for peak in evidence.peaks for f in peak.frequencies_hz(period_s)),
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


def _invisible(evidence: Evidence, signatures: Sequence[Signature]) -> dict[str, str]:
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
    shapes = [told[k.name] if k.name in told else shapes_of(k, scales) for k in kinds]
    return all_signatures(shapes, evidence, responder, progress)


def _figures(model: Model, evidence: Evidence) -> Figures:
    looks = tuple((look.statistic, look.sigma(0.0, 1)) for look in looks_at(model, evidence))
    return Figures(model.first.means, model.residual.means, evidence.table.names, looks)
