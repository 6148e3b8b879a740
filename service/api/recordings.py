"""`/v1/recordings`."""

from typing import Annotated

from fastapi import APIRouter, Query, Request, Response, status
from fastapi.responses import StreamingResponse
from starlette.concurrency import run_in_threadpool

from service.api import recording_files
from service.api.access import Admin, Operator
from service.api.answers.recording import RecordingAnswer, RecordingPage
from service.api.dependencies import SettingsDep, StoreDep
from service.api.importing import import_archive
from service.api.openapi import file_body, file_content, problems
from service.api.paging import Before, Limit
from service.api.recording_zip import files_of, zipped
from service.api.uploads import uploaded

router = APIRouter(prefix="/v1/recordings", tags=["recordings"])

_ZIP = "application/zip"


@router.get("", responses=problems())
def list_recordings(
    store: StoreDep,
    serial: str | None = None,
    band: str | None = None,
    limit: Limit = 100,
    before: Before = None,
) -> RecordingPage:
    """List recordings, newest first."""
    return RecordingPage.of(
        store.recordings.list(serial=serial, band=band, limit=limit, before=before)
    )


@router.get("/{digest}", responses=problems(404))
def get_recording(digest: str, store: StoreDep) -> RecordingAnswer:
    """Inspect a recording: its camera, its source, its blocks."""
    return RecordingAnswer.model_validate(store.recordings.get(digest))


@router.get(
    "/{digest}/file",
    response_class=StreamingResponse,
    responses={
        **problems(404),
        200: {
            "description": "A zip, as an import takes it.",
            "content": file_content(_ZIP),
        },
    },
)
def export_recording(digest: str, store: StoreDep) -> StreamingResponse:
    """Get a recording's files, packed while they are sent."""
    record = store.recordings.get(digest)
    headers = {"Content-Disposition": f'attachment; filename="{record.digest[:12]}.zip"'}
    return StreamingResponse(zipped(files_of(record)), media_type=_ZIP, headers=headers)


@router.delete("/{digest}", status_code=status.HTTP_204_NO_CONTENT, responses=problems(404, 409))
def delete_recording(digest: str, store: StoreDep, settings: SettingsDep, admin: Admin) -> None:
    """Delete a recording that no coefficient set, no run and no job refers to."""
    recording_files.delete_recording(digest, by=admin, settings=settings, store=store)


@router.post(
    "",
    status_code=status.HTTP_201_CREATED,
    responses={
        **problems(413, 415, 507),
        200: {"model": RecordingAnswer, "description": "It was here already."},
    },
    openapi_extra=file_body(
        "A zip of a recording folder, or of an .h5 and its .frames.jsonl.", _ZIP
    ),
)
async def import_recording(
    *,
    request: Request,
    response: Response,
    store: StoreDep,
    settings: SettingsDep,
    operator: Operator,
    name: Annotated[str, Query(max_length=200, description="For people.")] = "",
) -> RecordingAnswer:
    """Import a recording; one that is here already is answered as it is."""
    async with uploaded(request, _ZIP, settings) as archive:
        record, is_new = await run_in_threadpool(
            import_archive, archive, name=name, by=operator, settings=settings, store=store
        )
    if not is_new:
        response.status_code = status.HTTP_200_OK
    response.headers["Location"] = f"{router.prefix}/{record.digest}"
    return RecordingAnswer.model_validate(record)
