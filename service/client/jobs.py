"""Long work: asked for, waited for, cancelled, its files fetched."""

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, Literal

from calib.errors import InputError
from calib.recording.tone import Tone
from service.api.answers.job import JobAnswer, JobPage
from service.client.endings import FINAL, succeeded
from service.client.link import Link, given
from service.client.packing import ZIP, in_folder, packed

_PLACE = "/v1/jobs"


def _silent(_progress: float) -> None:
    """Say nothing."""


class Jobs:
    """`/v1/jobs`, and what begins one. A job that was asked for is not asked for again."""

    def __init__(self, link: Link) -> None:
        self._link = link

    def calibrate(
        self,
        recording: str,
        *,
        radiances: Mapping[float, float] | None = None,
        relative: bool = False,
        order: int | None = None,
        darks_required: bool = True,
        tone: Tone | None = None,
        model: str | None = None,
    ) -> JobAnswer:
        """Begin to derive a coefficient set from a recording; `result` names the draft.

        Args:
            recording: Its digest.
            radiances: By level, where the recording does not state them.
            relative: Whether to do without radiances.
            order: Of the vignette; None: as the data want it.
            darks_required: Whether a recording without darks is refused.
            tone: A known synchronous one, to be removed.
            model: A model file's text, whose departures are taken out.
        """
        wanted: dict[str, Any] = {
            "recording": recording, "relative": relative, "order": order,
            "darks_required": darks_required, "model": model,
        }  # fmt: skip
        if radiances is not None:
            wanted["radiances"] = {str(level): value for level, value in radiances.items()}
        if tone is not None:
            wanted["tone"] = asdict(tone)
        return self._link.post(JobAnswer, "/v1/calibrations", given(wanted))

    def photon_transfer(
        self, recording: str, *, method: Literal["ptc", "sanuc", "s3nuc"] = "ptc"
    ) -> JobAnswer:
        """Begin to determine a recording's system gain, by the whole curve or by two exposures."""
        wanted = {"recording": recording, "method": method}
        return self._link.post(JobAnswer, "/v1/photon-transfers", wanted)

    def diagnose(
        self, recording: str, *, second_recording: str | None = None, model: str | None = None
    ) -> JobAnswer:
        """Begin to look for what a recording, or two of one bench, show beyond a model.

        Args:
            recording: Its digest.
            second_recording: Another one's.
            model: A model file's text; None: the plain one, fitted.
        """
        wanted = {"recording": recording, "second_recording": second_recording, "model": model}
        return self._link.post(JobAnswer, "/v1/diagnoses", given(wanted))

    def transfer_function(
        self,
        scan: Path | str,
        *,
        method: Literal["regularised", "filter"] = "regularised",
        support: Literal[3, 5] = 3,
    ) -> JobAnswer:
        """Upload a folder with `mtf.toml` and `frames/`, or a zip of one, and begin to reduce it.

        Args:
            scan: The folder.
            method: Least squares on a compact PSF, or the paper's filter.
            support: Pixels along the side beyond which crosstalk is taken as 0.

        Raises:
            InputError: `not-a-scan`; nothing is sent then.
        """
        wanted = {"method": method, "support": support}
        with packed(Path(scan), _files) as archive:
            return self._link.post(
                JobAnswer, "/v1/transfer-functions", params=wanted, content=archive, headers=ZIP
            )

    def get(self, job_id: str) -> JobAnswer:
        """Return a job as it is now."""
        return self._link.get(JobAnswer, f"{_PLACE}/{job_id}")

    def all(self) -> Iterator[JobAnswer]:
        """Yield every job, newest first."""
        return self._link.pages(JobPage, _PLACE)

    def cancel(self, job_id: str) -> JobAnswer:
        """End it at once; one that is done stays as it is."""
        return self._link.post(JobAnswer, f"{_PLACE}/{job_id}/cancel", repeatable=True)

    def wait(
        self,
        job_id: str,
        *,
        on_progress: Callable[[float], None] = _silent,
        every_s: float = 0.25,
    ) -> JobAnswer:
        """Return the job once it has succeeded.

        Args:
            job_id: The job.
            on_progress: Told the share that is done, 0 to 1, when it has changed.
            every_s: How often the service is asked.

        Raises:
            WorkFailedError: It came to another end; the code is the job's.
        """
        told: float | None = None
        while (job := self.get(job_id)).state not in FINAL:
            if job.progress is not None and job.progress != told:
                told = job.progress
                on_progress(told)
            time.sleep(every_s)
        return succeeded("job", job)

    def download(self, job_id: str, name: str, out: Path | str) -> Path:
        """Write a file that a job left, one of its `files`, to `out`."""
        return self._link.download(f"{_PLACE}/{job_id}/files/{name}", out)

    def download_all(self, job_id: str, folder: Path | str) -> tuple[Path, ...]:
        """Write every file that a job left into a folder, by its name."""
        names = [Path(each.name).name for each in self.get(job_id).files]
        return tuple(self.download(job_id, name, Path(folder) / name) for name in names)


def _files(scan: Path) -> dict[str, Path]:
    if not (scan / "mtf.toml").is_file():
        msg = f"{scan} is no scan: name a folder with mtf.toml, or a .zip of one"
        raise InputError(msg, code="not-a-scan")
    return in_folder(scan)
