"""From an uploaded recording to radiance, on SQLite and on PostgreSQL: the same story."""

from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.correction.apply import Correction
from calib.recording.open import open_recording
from service.client import Client, ProblemError
from service.settings import Settings
from service.store.check.check import check
from tests.service.client.darkness import wait_until

EXPOSURE_US = 40.0


@pytest.fixture
def store_url(url: str) -> str:
    return url


def test_a_recording_is_calibrated_verified_certified_found_and_applied(
    client: Client, settings: Settings, recording_file: Path, tmp_path: Path
) -> None:
    digest = client.recordings.upload(recording_file, name="sweep").digest
    job = client.jobs.wait(client.jobs.calibrate(digest).id, every_s=0.05)
    assert job.result is not None
    sets, set_id = client.coefficient_sets, str(job.result["coefficient_set"])
    made = sets.get(set_id)
    assert (made.state, made.recording_digest) == ("draft", digest)
    assert made.transitions[0].by == "local"
    assert "path" not in str(job.request)
    assert sets.verify(set_id, reason="curves look right").state == "verified"
    now = datetime.now(UTC)
    sets.certify(set_id, valid_from=now, reason="first calibration")
    assert sets.lookup(serial="D0001", band="NIR", bit_depth=12, at=now).id == set_id
    with pytest.raises(ProblemError) as refused:
        sets.lookup(serial="D0001", band="NIR", bit_depth=12, at=now - timedelta(seconds=1))
    assert refused.value.code == "not-found"
    coefficients = CoefficientSet.load(sets.download(set_id, tmp_path / "set.h5"))
    assert coefficients.id == set_id
    flat = next(each for each in open_recording(recording_file).header.blocks if each.level)
    lines = np.concatenate(list(open_recording(recording_file).frames(flat.block)))
    applied = sets.apply(set_id, lines, exposure_us=EXPOSURE_US, at=now)
    expected = Correction(coefficients, EXPOSURE_US, camera=coefficients.camera).lines(lines)
    np.testing.assert_array_equal(applied.radiance, expected.radiance)
    wait_until(lambda: not any(settings.work_folder.iterdir()))  # cleared after its record
    assert [each.action for each in client.audit.all()] == [
        "coefficient-set.certified", "coefficient-set.verified", "coefficient-set.draft",
        "recording.import",
    ]  # fmt: skip
    proof = client.audit.verify()
    assert proof.entries == 4
    checked = check(settings, lambda _share, _doing: None)
    assert (checked.findings, checked.audit_digest) == ((), proof.digest)
    assert (checked.coefficient_sets, checked.recordings) == (1, 1)
