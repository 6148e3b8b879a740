"""The OpenAPI document: complete, with the problems that each operation answers with."""

from collections import defaultdict
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from pydantic import BaseModel

from service.api.openapi_examples import add_examples
from service.api.problem_codes import SAID, STATUS
from service.api.problems import MEDIA_TYPE, Problem

_WHAT = {
    304: "Not modified.",
    401: "A key is needed, or this one is not good.",
    403: "The key's scope does not allow it.",
    404: "Nothing is known by that name.",
    409: "Its state does not allow that.",
    413: "Larger than this service accepts.",
    415: "Not of a media type that this operation takes.",
    421: "Asked by a name that this service does not answer to.",
    422: "The request cannot be used as it is.",
    423: "Somebody else has the bench.",
    429: "Too many jobs are waiting.",
    500: "A defect in darkflat.",
    502: "A device does not do what it should.",
    503: "The store or the bench cannot be used now, or no jobs are done any more.",
    507: "The disk is full.",
}
_ALWAYS = (
    "unknown-host", "invalid-request", "internal-error", "store-busy", "store-not-writable",
)  # fmt: skip
_KEYED = ("key-needed", "key-refused", "scope-missing")
BENCH = ("no-bench", "bench-not-ready")
"""What operations answer with that need the bench."""

Responses = dict[int | str, dict[str, Any]]
_REF = "#/components/schemas/{model}"


def problems(*those: int | str, keyless: bool = False) -> Responses:
    """Return the `responses` of an operation that may answer with these problems.

    Args:
        those: Codes, or statuses for all codes of them; beside those of every operation.
        keyless: Whether it is answered without a key.
    """
    codes = {each for each in those if isinstance(each, str)} | {*_ALWAYS}
    codes |= set() if keyless else {*_KEYED}
    statuses = {each for each in those if isinstance(each, int)}
    codes |= {code for code in SAID if STATUS[code] in statuses}
    by_status: dict[int, list[str]] = defaultdict(list, {each: [] for each in statuses})
    for code in sorted(codes):
        by_status[STATUS[code]].append(code)
    return {status: _response(status, by_status[status]) for status in sorted(by_status)}


def _response(status: int, codes: list[str]) -> dict[str, Any]:
    if status == HTTPStatus.NOT_MODIFIED:
        return {"description": _WHAT[status]}
    content: dict[str, Any] = {"schema": {"$ref": _REF.format(model="Problem")}}
    if codes:
        content["examples"] = {code: {"value": _example(status, code)} for code in codes}
    return {"description": _WHAT[status], "content": {MEDIA_TYPE: content}}


def _example(status: int, code: str) -> dict[str, Any]:
    return {
        "type": f"urn:darkflat:problem:{code}",
        "title": HTTPStatus(status).phrase,
        "status": status,
        "detail": SAID[code],
        "code": code,
    }


def json_body(model: type[BaseModel], example: dict[str, Any]) -> dict[str, Any]:
    """Return the `openapi_extra` of an operation that reads its body itself, as `model`."""
    schema = {"$ref": _REF.format(model=model.__name__)}
    content = {"application/json": {"schema": schema, "example": example}}
    return {"requestBody": {"required": True, "content": content}}


def file_content(*media_types: str) -> dict[str, Any]:
    """Return the `content` of a body that is a file of one of these types."""
    return {each: {"schema": {"type": "string", "format": "binary"}} for each in media_types}


def file_body(description: str, *media_types: str) -> dict[str, Any]:
    """Return the `openapi_extra` of an operation that takes a file as its body."""
    content = file_content(*media_types)
    return {"requestBody": {"required": True, "description": description, "content": content}}


def describe_api(app: FastAPI, *models: type[BaseModel]) -> None:
    """Make `app.openapi()` complete: every problem is a `Problem`, and `models` are in it."""

    def document() -> dict[str, Any]:
        if app.openapi_schema is None:
            made = get_openapi(
                title=app.title,
                version=app.version,
                summary=app.summary,
                description=app.description,
                routes=app.routes,
            )
            schemas = made.setdefault("components", {}).setdefault("schemas", {})
            described: tuple[type[BaseModel], ...] = (Problem, *models)
            for model in described:
                schema = model.model_json_schema(ref_template=_REF)
                schemas.update(schema.pop("$defs", {}))
                schemas[model.__name__] = schema
            for methods in made["paths"].values():
                for operation in methods.values():
                    if "requestBody" in operation:
                        operation["responses"].setdefault("413", problems(413)[413])
            for unused in ("HTTPValidationError", "ValidationError"):
                schemas.pop(unused, None)
            add_examples(made)
            app.openapi_schema = made
        return app.openapi_schema

    app.openapi = document  # type: ignore[method-assign]  # FastAPI's own way to extend it
