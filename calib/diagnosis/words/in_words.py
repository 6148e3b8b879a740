"""Puts words to a diagnosis: of each finding, and of all together."""

from dataclasses import replace

from calib.diagnosis.answer.amended import beside
from calib.diagnosis.answer.diagnosis import Diagnosis
from calib.diagnosis.answer.empirical import empirical_term
from calib.diagnosis.answer.finding import Finding
from calib.diagnosis.answer.hidden import absorbed_of, hid_as
from calib.diagnosis.answer.radiance_check import radiance_error
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.naming.model import Model
from calib.diagnosis.words.scales import RecordingScales
from calib.diagnosis.words.sentences import sentence_of
from calib.diagnosis.words.telling import Telling
from calib.diagnosis.words.verdict import first_sentence


def in_words(diagnosis: Diagnosis, model: Model, evidence: Evidence) -> Diagnosis:
    """Return the diagnosis with its sentences, and with what it does to radiance."""
    gain = beside(model, evidence).gain_dn_per_e
    scales = RecordingScales.of(evidence, float(gain.mean()))
    place = {m.signature.shape.name: k for k, m in enumerate(model.members)}
    found = tuple(
        _told(each, place[each.effect.name], model, evidence, scales) for each in diagnosis.findings
    )
    rest = diagnosis.unexplained
    if rest is not None:
        rest = replace(rest, term=empirical_term(model, evidence))
    told = replace(
        diagnosis, findings=found, unexplained=rest, radiance=radiance_error(model, evidence)
    )
    return replace(told, summary=first_sentence(told))


def _told(
    finding: Finding, k: int, model: Model, evidence: Evidence, scales: RecordingScales
) -> Finding:
    absorbed = absorbed_of(k, model, evidence)
    return replace(
        finding,
        sentence=sentence_of(Telling(finding.effect, finding.parameters, scales)),
        hid_as=hid_as(absorbed),
        absorbed=absorbed or (),
    )
