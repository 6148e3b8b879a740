"""Diagnoses a recording: what the plain model lacks, what it is called, how much of it there is."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from calib.diagnosis.answer import known_strengths
from calib.diagnosis.answer.description import describe
from calib.diagnosis.answer.diagnosis import Diagnosis, Fit, Unexplained
from calib.diagnosis.answer.figures import Figures
from calib.diagnosis.answer.found import findings_of
from calib.diagnosis.baseline.fitted_links import BASELINE
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.gathered import gathered_evidence
from calib.diagnosis.given.given_model import parameters_off
from calib.diagnosis.given.known import beside, known_departures, of_known_baseline
from calib.diagnosis.given.parameter_off import ParameterOff
from calib.diagnosis.given.size import check_size
from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.heldout import HeldOutDeviances
from calib.diagnosis.naming.model import Model
from calib.diagnosis.naming.remainder import CERTAIN_SIGMA, looks_at, worst
from calib.diagnosis.naming.search import as_found, find
from calib.diagnosis.recorded.limits import limits
from calib.diagnosis.signatures.looked_for import not_testable, not_visible, signatures_of
from calib.diagnosis.signatures.signature import Signature
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.diagnosis.statistics.steps import steps
from calib.diagnosis.words.in_words import in_words
from calib.forward.model import Model as ForwardModel
from calib.recording.header import RecordingHeader
from calib.recording.protocol import Recording

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
    off: tuple[ParameterOff, ...] = ()
    if given is not None:
        off = parameters_off(given, of_known_baseline(known, evidence))
        off += known.off if known is not None else ()
    lacking = {**not_testable(evidence), **not_visible(evidence, signatures)}
    diagnosis = _diagnosis(model, as_found(contest, model), lacking, off)
    return Examination(evidence, signatures, model, in_words(diagnosis, model, evidence))


def _diagnosis(
    model: Model, contest: Contest, lacking: dict[str, str], off: tuple[ParameterOff, ...]
) -> Diagnosis:
    """Return what a model says, without the sentences."""
    evidence = contest.evidence
    heldout = HeldOutDeviances(model, evidence)
    before, after = heldout.of(()), heldout.of(range(len(model.members)))
    names = tuple(m.signature.shape.name for m in model.members)
    return Diagnosis(
        Fit(BASELINE, before.deviance, before.dof),
        findings_of(model, contest, heldout),
        Fit((*BASELINE, *names), after.deviance, after.dof),
        _unexplained(model, evidence),
        lacking,
        off,
        _figures(model, evidence),
        remarks=(
            *limits(RecordingHeader(camera=evidence.table.camera, blocks=evidence.table.blocks)),
            *steps(evidence.sums, evidence.table.names, evidence.sensor),
            *known_strengths.remarks(m.effect for m in model.members),
        ),
    )


def _unexplained(model: Model, evidence: Evidence) -> Unexplained | None:
    look, sigma = worst(model, evidence)
    if sigma <= CERTAIN_SIGMA:
        return None
    return Unexplained(sigma, describe(look, model, evidence))


def _figures(model: Model, evidence: Evidence) -> Figures:
    looks = tuple((look.statistic, look.sigma(0.0, 1)) for look in looks_at(model, evidence))
    return Figures(model.first.means, model.residual.means, evidence.table.names, looks)
