"""`/v1/coefficient-sets/{id}/apply`: raw lines in, radiance out."""

import tempfile
from dataclasses import dataclass
from typing import IO, Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import StreamingResponse
from pydantic import AwareDatetime, BaseModel, ConfigDict, Field
from starlette.concurrency import run_in_threadpool

from calib.errors import InputError
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.correction.apply import Correction
from calib.radiometric.correction.apply_checks import Validity
from calib.recording.header import MOST_PIXELS
from service.api.dependencies import SettingsDep, StoreDep
from service.api.openapi import file_body, file_content, problems
from service.api.radiance_stream import radiance_npz
from service.api.raw_lines import UploadedLines, uploaded_lines
from service.api.uploads import check_media_type, receive
from service.store.records import SetRecord
from service.store.state import SetState
from service.store.store import Store

router = APIRouter(prefix="/v1/coefficient-sets", tags=["coefficient sets"])

_NPY, _BYTES, _NPZ = "application/x-npy", "application/octet-stream", "application/x-npz"


class Taken(BaseModel):
    """How the lines were taken; what is not stated is taken to be as in the set, and noted."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)

    exposure_us: float = Field(gt=0)
    at: AwareDatetime | None = Field(default=None, description="When; needed by a validity.")
    serial: str | None = None
    band: str | None = None
    gain: float | None = Field(default=None, description="dB")
    black_level: float | None = Field(default=None, description="DN")
    bit_depth: int | None = Field(default=None, ge=8, le=16)
    first_column: int | None = Field(
        default=None, ge=0, lt=MOST_PIXELS, description="Where the lines begin on the sensor."
    )
    temperature: float | None = Field(default=None, description="Of the sensor, °C.")
    force: bool = Field(default=False, description="Although the set does not match; flags tell.")


@router.post(
    "/{set_id}/apply",
    response_class=StreamingResponse,
    responses={
        **problems(404, "not-certified", 413, 415),
        200: {
            "description": "An .npz with radiance, std and flags, and notes.json.",
            "content": file_content(_NPZ),
        },
    },
    openapi_extra=file_body(
        "Raw lines, (n_lines, n_columns) uint8 or uint16, as .npy.", _NPY, _BYTES
    ),
)
async def apply_set(
    set_id: str,
    request: Request,
    taken: Annotated[Taken, Query()],
    store: StoreDep,
    settings: SettingsDep,
) -> StreamingResponse:
    """Correct raw lines; neither the upload nor the answer is ever held in memory as a whole."""
    check_media_type(request, _NPY, _BYTES)
    chosen = await run_in_threadpool(_choose, store, set_id, taken)
    spool: IO[bytes] = tempfile.TemporaryFile(dir=settings.work_folder)  # noqa: SIM115  (streamed)
    try:
        n_bytes = await receive(request, spool, limit_bytes=settings.max_frames_bytes)
        lines = await run_in_threadpool(_lines, spool, n_bytes, chosen)
    except BaseException:
        spool.close()
        raise
    body = radiance_npz(chosen.correction, lines, chosen.notes)
    return StreamingResponse(body, media_type=_NPZ)


@dataclass(frozen=True)
class _Chosen:
    correction: Correction
    notes: tuple[str, ...]


def _lines(spool: IO[bytes], n_bytes: int, chosen: _Chosen) -> UploadedLines:
    n_columns = chosen.correction.coefficients.n_columns
    return uploaded_lines(spool, n_bytes, n_columns=n_columns)


def _choose(store: Store, set_id: str, taken: Taken) -> _Chosen:
    """Return the set made ready, and what a reader of the result has to know."""
    record = store.sets.get(set_id)
    notes = _check_state(record, force=taken.force)
    coefficients = store.sets.files.load(record.id)
    held = record.certification
    correction = Correction(
        coefficients,
        taken.exposure_us,
        camera=coefficients.camera.model_copy(update=_stated(taken)),
        at=taken.at,
        validity=None if held is None else Validity(held.valid_from, held.until),
        sensor_temperature_c=taken.temperature,
        force=taken.force,
    )
    return _Chosen(correction, (*notes, *_assumed(coefficients, taken), *correction.notes))


def _check_state(record: SetRecord, *, force: bool) -> tuple[str, ...]:
    if record.state in {SetState.CERTIFIED, SetState.SUPERSEDED}:
        return ()
    text = f"coefficient set {record.id[:12]} is {record.state}, not certified"
    if not force:
        msg = f"{text}; certify it, or force it"
        raise InputError(msg, code="not-certified")
    return (text,)


def _stated(taken: Taken) -> dict[str, object]:
    """Return what the client says of the camera; its start time is not the lines'."""
    said = {
        "serial": taken.serial,
        "band": taken.band,
        "gain_db": taken.gain,
        "black_level_dn": taken.black_level,
        "bit_depth": taken.bit_depth,
        "first_column": taken.first_column,
    }
    return {"started_at": None} | {key: value for key, value in said.items() if value is not None}


def _assumed(coefficients: CoefficientSet, taken: Taken) -> tuple[str, ...]:
    names = ("serial", "band", "gain", "black_level", "bit_depth", "first_column")
    unstated = [name for name in names if getattr(taken, name) is None]
    if not unstated:
        return ()
    return (f"not stated and taken as in the set {coefficients.id[:12]}: {', '.join(unstated)}",)
