"""From evidence to what simulates changes about its baseline."""

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.simulation.chain_run import FittedChain
from calib.diagnosis.simulation.response import Responder


def responder_of(evidence: Evidence) -> Responder:
    """Return what simulates changes about the fitted baseline."""
    chain = FittedChain(evidence.baseline, evidence.table, evidence.sensor)
    return Responder(chain, evidence.counts, evidence.peaks)
