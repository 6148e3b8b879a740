"""From recordings to evidence: gathered one after the other, and looked at together."""

from collections.abc import Callable, Sequence

from calib.diagnosis.baseline.requirements import check_can_be_diagnosed, check_determined
from calib.diagnosis.baseline.scenes import with_steady_light
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.fitted_evidence import evidence_of
from calib.diagnosis.recorded.joint import joint, joint_images
from calib.diagnosis.recorded.scene_light import steady_images
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.block_sums import BlockSums
from calib.diagnosis.statistics.gather import gather
from calib.recording.protocol import Recording

Progress = Callable[[float], None]


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
