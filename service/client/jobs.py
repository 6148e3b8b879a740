"""Long work: asked for, waited for, cancelled."""

import time
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from service.api.answers.job import JobAnswer, JobPage
from service.client.errors import WorkFailedError
from service.client.link import Link

FINAL = frozenset({"succeeded", "failed", "cancelled", "interrupted"})


def _silent(_progress: float) -> None:
    """Say nothing."""


class Jobs:
    """`/v1/jobs`, and what begins one."""

    def __init__(self, link: Link) -> None:
        self._link = link

    def calibrate(
        self, recording: str, *, radiances: Mapping[float, float] | None = None, **options: Any
    ) -> JobAnswer:
        """Begin to derive a coefficient set from a recording.

        Args:
            recording: Its digest.
            radiances: By level, where the recording does not state them.
            options: `relative`, `order`, `darks_required`, `tone`, `model`, as the API has them.
        """
        wanted: dict[str, Any] = {"recording": recording, **options}
        if radiances is not None:
            wanted["radiances"] = {str(level): value for level, value in radiances.items()}
        return self._link.post(JobAnswer, "/v1/calibrations", wanted)

    def get(self, job_id: str) -> JobAnswer:
        """Return a job as it is now."""
        return self._link.get(JobAnswer, f"/v1/jobs/{job_id}")

    def all(self) -> Iterator[JobAnswer]:
        """Yield every job, newest first."""
        return self._link.pages(JobPage, "/v1/jobs")

    def cancel(self, job_id: str) -> JobAnswer:
        """End it at once; one that is done stays as it is."""
        return self._link.post(JobAnswer, f"/v1/jobs/{job_id}/cancel", repeatable=True)

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
        if job.state != "succeeded":
            text = f"job {job_id} is {job.state}" if job.error is None else job.error.message
            code = f"job-{job.state}" if job.error is None else job.error.code
            raise WorkFailedError(text, code=code, state=job.state)
        return job
