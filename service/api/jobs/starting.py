"""How a job of any kind begins: in a folder of its own, with a place where it is followed."""

import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from fastapi import Response
from pydantic import BaseModel

from service.api.answers.job import JobAnswer
from service.api.dependencies import Parts
from service.api.jobs.scratch import FILES, new_scratch

Prepare = Callable[[Path], Mapping[str, Any]]
"""Told the job's folder; returns what its work needs beside the request, which nobody is shown."""
Finish = Callable[[Path, dict[str, Any]], dict[str, Any]]
"""Told that folder and a good result, in the server; returns the answer."""


def _as_it_is(_scratch: Path, result: dict[str, Any]) -> dict[str, Any]:
    return result


def start_job(
    kind: str,
    wanted: BaseModel,
    *,
    known: Parts,
    response: Response,
    prepare: Prepare,
    finish: Finish = _as_it_is,
) -> JobAnswer:
    """Queue a job and let `response` say where it is followed.

    Args:
        kind: One of `work.KINDS`.
        wanted: What the client asked for; kept on record.
        known: The service.
        response: Gets its `Location`.
        prepare: What the work needs besides.
        finish: What is done with the result before it is on record.
    """
    scratch = new_scratch(known.settings)
    try:
        private = {"files": str(scratch / FILES), **prepare(scratch)}
        record = known.runner.submit(
            kind,
            wanted.model_dump(mode="json"),
            private,
            lambda result: finish(scratch, result),
            scratch=scratch,
        )
    except BaseException:
        shutil.rmtree(scratch, ignore_errors=True)
        raise
    response.headers["Location"] = f"/v1/jobs/{record.id}"
    return JobAnswer.of(record)
