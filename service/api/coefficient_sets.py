"""`/v1/coefficient-sets`: their lives, and which one is in force."""

from datetime import UTC, datetime
from typing import Annotated

from fastapi import APIRouter, Header, Query, Response
from fastapi.responses import FileResponse
from pydantic import AwareDatetime, BaseModel, ConfigDict, Field

from service.api.access import Certifier, Operator
from service.api.answers.coefficient_set import SetAnswer, SetPage
from service.api.dependencies import StoreDep
from service.api.etags import matches, quoted
from service.api.openapi import problems
from service.api.paging import Before, Limit
from service.store.records import SetRecord
from service.store.state import SetState

router = APIRouter(prefix="/v1/coefficient-sets", tags=["coefficient sets"])

_HDF5 = "application/x-hdf5"
IfNoneMatch = Annotated[str | None, Header()]


class _Request(BaseModel):
    model_config = ConfigDict(extra="forbid")


class Verification(_Request):
    """Somebody looked at a draft."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"reason": "residuals are noise"}]})

    reason: str = Field(default="", max_length=2000)


class Certification(_Request):
    """A verified set holds for a time."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [{"valid_from": "2026-12-01T00:00:00Z", "reason": "yearly calibration"}]
        }
    )

    valid_from: AwareDatetime
    valid_until: AwareDatetime | None = Field(default=None, description="Excluded; null is open.")
    reason: str = Field(min_length=1, max_length=2000)
    supersedes: tuple[str, ...] = Field(
        default=(), max_length=100, description="Sets that hold up to then, and never after."
    )


class Revocation(_Request):
    """A set was wrong."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"reason": "lamp 2 was aged"}]})

    reason: str = Field(min_length=1, max_length=2000)


@router.get("", responses=problems())
def list_sets(
    *,
    store: StoreDep,
    state: SetState | None = None,
    serial: str | None = None,
    band: str | None = None,
    recording: str | None = None,
    limit: Limit = 100,
    before: Before = None,
) -> SetPage:
    """List coefficient sets, newest first."""
    page = store.sets.list(
        state=state, serial=serial, band=band, recording=recording, limit=limit, before=before
    )
    return SetPage.of(page)


@router.get("/lookup", responses=problems(404))
def lookup_set(
    *,
    store: StoreDep,
    serial: str,
    bit_depth: Annotated[int, Query(ge=8, le=16)],
    band: str = "",
    region: Annotated[str | None, Query(description="As sets state it, such as 0:6144.")] = None,
    gain: Annotated[float, Query(allow_inf_nan=False, description="dB")] = 0.0,
    at: Annotated[AwareDatetime | None, Query(description="Now, where not given.")] = None,
) -> SetAnswer:
    """Find the set that is in force for a camera setting at a time."""
    record = store.sets.lookup(
        serial=serial,
        band=band,
        gain_db=gain,
        bit_depth=bit_depth,
        region=region,
        at=datetime.now(UTC) if at is None else at,
    )
    return SetAnswer.model_validate(record)


@router.get("/{set_id}", response_model=SetAnswer, responses=problems(304, 404))
def get_set(
    set_id: str, response: Response, store: StoreDep, if_none_match: IfNoneMatch = None
) -> SetAnswer | Response:
    """Show a set and its life; its `ETag` changes when its state does."""
    record = store.sets.get(set_id)
    if matches(if_none_match, record.version):
        return Response(status_code=304, headers={"ETag": quoted(record.version)})
    return _answer(record, response)


@router.get(
    "/{set_id}/file",
    response_class=FileResponse,
    responses={**problems(304, 404), 200: {"content": {_HDF5: {}}, "description": "The file."}},
)
def get_set_file(set_id: str, store: StoreDep, if_none_match: IfNoneMatch = None) -> Response:
    """Download a set's file; its content never changes, and neither does its `ETag`."""
    record = store.sets.get(set_id)
    tag = {"ETag": quoted(record.id), "Cache-Control": "private, max-age=31536000, immutable"}
    if matches(if_none_match, record.id):
        return Response(status_code=304, headers=tag)
    store.sets.files.load(record.id)  # never hand out an altered one
    path = store.sets.files.path(record.id)
    return FileResponse(path, media_type=_HDF5, filename=path.name, headers=tag)


@router.post("/{set_id}/verify", responses=problems(404, "illegal-transition"))
def verify_set(
    set_id: str, said: Verification, response: Response, store: StoreDep, operator: Operator
) -> SetAnswer:
    """Say that a draft was looked at; its file is checked against its id."""
    return _answer(store.sets.verify(set_id, by=operator, reason=said.reason), response)


@router.post(
    "/{set_id}/certify", responses=problems(404, "illegal-transition", "overlapping-certification")
)
def certify_set(
    set_id: str, said: Certification, response: Response, store: StoreDep, certifier: Certifier
) -> SetAnswer:
    """Certify a verified set for a time; what overlaps must be named as superseded."""
    record = store.sets.certify(
        set_id,
        valid_from=said.valid_from,
        valid_until=said.valid_until,
        by=certifier,
        reason=said.reason,
        supersedes=said.supersedes,
    )
    return _answer(record, response)


@router.post("/{set_id}/revoke", responses=problems(404, "illegal-transition"))
def revoke_set(
    set_id: str, said: Revocation, response: Response, store: StoreDep, certifier: Certifier
) -> SetAnswer:
    """Say that a set was wrong: it holds for no time any more."""
    return _answer(store.sets.revoke(set_id, by=certifier, reason=said.reason), response)


def _answer(record: SetRecord, response: Response) -> SetAnswer:
    response.headers["ETag"] = quoted(record.version)
    return SetAnswer.model_validate(record)
