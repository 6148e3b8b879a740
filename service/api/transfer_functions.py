"""`/v1/transfer-functions`: from an uploaded scan of a grating to the pixel's MTF, as a job."""

import shutil
from enum import IntEnum
from pathlib import Path
from typing import Annotated, Literal

from fastapi import APIRouter, Query, Request, Response, status
from pydantic import BaseModel, ConfigDict, Field
from starlette.concurrency import run_in_threadpool

from calib.errors import InputError
from service.api.access import Operator
from service.api.answers.job import JobAnswer
from service.api.archive_names import names_of_the_archive
from service.api.dependencies import RunnerDep, SettingsDep
from service.api.jobs.runner import JobRunner
from service.api.jobs.scratch import FILES, new_scratch
from service.api.openapi import problems
from service.api.unpacking import unpack
from service.api.uploads import check_media_type, receive
from service.settings import Settings
from service.store.records import JobRecord

router = APIRouter(prefix="/v1/transfer-functions", tags=["transfer functions"])

_ZIP = "application/zip"


class Support(IntEnum):
    """Pixels along a side."""

    THREE = 3
    FIVE = 5


class Wanted(BaseModel):
    """How a scan is reduced."""

    model_config = ConfigDict(extra="forbid")

    method: Literal["regularised", "filter"] = Field(
        default="regularised", description="Least squares on a compact PSF, or the paper's filter."
    )
    support: Support = Field(
        default=Support.THREE, description="Pixels beyond which crosstalk is taken as 0."
    )


@router.post(
    "",
    status_code=status.HTTP_202_ACCEPTED,
    responses=problems(413, 415, 429, 507),
    openapi_extra={
        "requestBody": {
            "required": True,
            "description": "A zip of a folder with mtf.toml and frames/.",
            "content": {_ZIP: {"schema": {"type": "string", "format": "binary"}}},
        }
    },
)
async def start_transfer_function(
    *,
    request: Request,
    response: Response,
    wanted: Annotated[Wanted, Query()],
    settings: SettingsDep,
    runner: RunnerDep,
    _operator: Operator,
) -> JobAnswer:
    """Queue the reduction of a scan; its job leaves the transfer function and its figures."""
    check_media_type(request, _ZIP)
    scratch = await run_in_threadpool(new_scratch, settings)
    try:
        archive = scratch / "scan.zip"
        with archive.open("xb") as file:
            await receive(request, file, limit_bytes=settings.max_upload_bytes)
        record = await run_in_threadpool(_queued, wanted, scratch, archive, settings, runner)
    except BaseException:
        shutil.rmtree(scratch, ignore_errors=True)
        raise
    response.headers["Location"] = f"/v1/jobs/{record.id}"
    return JobAnswer.of(record)


def _queued(
    wanted: Wanted, scratch: Path, archive: Path, settings: Settings, runner: JobRunner
) -> JobRecord:
    """Unpack the archive, look at what it says of itself, and queue the work."""
    from calib.mtf.reading import read_toml  # noqa: PLC0415  (slow to import)

    unpacked = scratch / "unpacked"
    unpacked.mkdir()
    unpack(
        archive,
        unpacked,
        limit_bytes=settings.max_upload_bytes,
        limit_files=settings.max_upload_files,
    )
    archive.unlink()
    found = list(unpacked.rglob("mtf.toml"))
    if len(found) != 1:
        msg = "the archive does not hold exactly one mtf.toml: pack the folder of one scan"
        raise InputError(msg, code="not-a-scan")
    with names_of_the_archive(unpacked):
        read_toml(found[0].parent)
    return runner.submit(
        "transfer-function",
        wanted.model_dump(mode="json"),
        {"scan_path": str(found[0].parent), "files": str(scratch / FILES)},
        lambda result: result,
        scratch=scratch,
    )
