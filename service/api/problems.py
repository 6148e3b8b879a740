"""Errors as RFC 9457 problem details, with the same stable codes as everywhere else.

Never a stack trace: what is not expected is logged here and answered as `internal-error`.
"""

import logging
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import BaseModel, Field
from starlette.exceptions import HTTPException

from calib.errors import DarkflatError, InputError, NotDeterminedError
from drivers.errors import DeviceError
from service.api.problem_codes import STATUS
from service.store.errors import OverlapError
from service.store.plain_json import plain

MEDIA_TYPE = "application/problem+json"
_LOG = logging.getLogger(__name__)


class Problem(BaseModel):
    """What went wrong: RFC 9457, with darkflat's code."""

    type: str = Field(examples=["urn:darkflat:problem:not-found"])
    title: str = Field(examples=["Not Found"])
    status: int = Field(examples=[404])
    detail: str = Field(examples=["the store has no coefficient set '0123abcd'; list them"])
    code: str = Field(examples=["not-found"])
    """Stable, for scripts."""
    device: str | None = None
    """Which device, where one failed."""
    last_exchange: str | None = None
    """The last bytes exchanged with it."""
    standing: list[str] | None = None
    """The coefficient sets that stand in the way."""
    errors: list[dict[str, Any]] | None = None
    """Which parts of the request are wrong."""


def problem(status: int, detail: str, code: str, **more: Any) -> JSONResponse:
    """Return the answer that says what went wrong."""
    content = Problem(
        type=f"urn:darkflat:problem:{code}",
        title=HTTPStatus(status).phrase,
        status=status,
        detail=detail,
        code=code,
        **more,
    )
    return JSONResponse(
        content.model_dump(exclude_none=True), status_code=status, media_type=MEDIA_TYPE
    )


def status_of(error: DarkflatError) -> int:
    """Return the HTTP status for an error: by its code, else by its kind."""
    if error.code in STATUS:
        return STATUS[error.code]
    if isinstance(error, InputError | NotDeterminedError):
        return 422
    if isinstance(error, DeviceError):
        return 502
    return 500


def add_problem_handlers(app: FastAPI) -> None:
    """Make `app` answer every error as a problem."""
    app.add_exception_handler(DarkflatError, _on_darkflat_error)
    app.add_exception_handler(RequestValidationError, _on_invalid_request)
    app.add_exception_handler(HTTPException, _on_http_exception)
    app.add_exception_handler(Exception, _on_defect)


def _on_darkflat_error(_request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, DarkflatError)  # noqa: S101  (what it is registered for)
    more: dict[str, Any] = {}
    if isinstance(error, DeviceError):
        more = {"device": error.device, "last_exchange": error.last_exchange or None}
    if isinstance(error, OverlapError):
        more = {"standing": list(error.standing)}
    answer = problem(status_of(error), str(error), error.code, **more)
    if answer.status_code == HTTPStatus.UNAUTHORIZED:
        answer.headers["WWW-Authenticate"] = "Bearer"
    return answer


def _on_invalid_request(_request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, RequestValidationError)  # noqa: S101
    wrong = [
        {"where": [str(part) for part in each["loc"]], "what": each["msg"]}
        for each in error.errors()
    ]
    first = wrong[0]
    detail = f"{'.'.join(first['where'])}: {first['what']}"
    return problem(422, detail, "invalid-request", errors=plain(wrong))


def _on_http_exception(_request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, HTTPException)  # noqa: S101
    if error.status_code == HTTPStatus.BAD_REQUEST:  # FastAPI's, of a body that is no UTF-8
        msg = "the body cannot be read as JSON; send JSON in UTF-8"
        return problem(422, msg, "invalid-request")
    code = HTTPStatus(error.status_code).phrase.lower().replace(" ", "-")
    if error.status_code == HTTPStatus.REQUEST_ENTITY_TOO_LARGE:
        code = "too-large"  # as everywhere else
    answer = problem(error.status_code, str(error.detail), code)
    answer.headers.update(error.headers or {})
    return answer


def _on_defect(request: Request, error: Exception) -> JSONResponse:
    _LOG.error("%s %s failed", request.method, request.url.path, exc_info=error)
    return problem(500, "a defect in darkflat; its log says more", "internal-error")
