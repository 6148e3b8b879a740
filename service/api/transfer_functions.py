"""`/v1/transfer-functions`: from an uploaded scan of a grating to the pixel's MTF, as a job."""

from enum import IntEnum
from pathlib import Path
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Request, Response, status
from pydantic import BaseModel, ConfigDict, Field
from starlette.concurrency import run_in_threadpool

from calib.errors import InputError
from service.api.access import Operator
from service.api.answers.job import JobAnswer
from service.api.archive_names import names_of_the_archive
from service.api.dependencies import PartsDep
from service.api.jobs.starting import start_job
from service.api.openapi import file_body, problems
from service.api.unpacking import unpack
from service.api.uploads import uploaded
from service.settings import Settings

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
    openapi_extra=file_body("A zip of a folder with mtf.toml and frames/.", _ZIP),
)
async def start_transfer_function(
    *,
    request: Request,
    response: Response,
    wanted: Annotated[Wanted, Query()],
    known: PartsDep,
    _operator: Operator,
) -> JobAnswer:
    """Queue the reduction of a scan; its job leaves the transfer function and its figures."""
    async with uploaded(request, _ZIP, known.settings) as archive:

        def prepare(scratch: Path) -> dict[str, Any]:
            folder = _unpacked(archive, scratch / "unpacked", known.settings)
            return {"scan_path": str(folder)}

        return await run_in_threadpool(
            start_job,
            "transfer-function",
            wanted,
            known=known,
            response=response,
            prepare=prepare,
        )


def _unpacked(archive: Path, into: Path, settings: Settings) -> Path:
    """Unpack the archive, look at what it says of itself, and return the folder of the scan."""
    from calib.mtf.reading import read_toml  # noqa: PLC0415  (slow to import)

    unpack(archive, into, settings)
    found = list(into.rglob("mtf.toml"))
    if len(found) != 1:
        msg = "the archive does not hold exactly one mtf.toml: pack the folder of one scan"
        raise InputError(msg, code="not-a-scan")
    with names_of_the_archive(into):
        read_toml(found[0].parent)
    return found[0].parent
