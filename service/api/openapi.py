"""The OpenAPI document: which problems each operation answers with."""

from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from service.api.problems import MEDIA_TYPE, Problem

_WHAT = {
    304: "Not modified.",
    404: "Nothing is known by that name.",
    409: "Its state does not allow that.",
    413: "Larger than this service accepts.",
    415: "Not of a media type that this operation takes.",
    401: "A key is needed, or this one is not good.",
    403: "The key's scope does not allow it.",
    422: "The request cannot be used as it is.",
    423: "Somebody else has the bench.",
    429: "Too many jobs are waiting.",
    502: "A device does not do what it should.",
    503: "The store cannot be used now, or no jobs are done any more.",
    507: "The disk is full.",
}

Responses = dict[int | str, dict[str, Any]]


def problems(*statuses: int, keyless: bool = False) -> Responses:
    """Return the `responses` of an operation that may answer with these problems.

    Args:
        statuses: Beside those that every operation may answer with.
        keyless: Whether it is answered without a key.
    """
    always = (422, 503) if keyless else (401, 403, 422, 503)
    schema = {"$ref": "#/components/schemas/Problem"}
    return {
        status: {"description": _WHAT[status], "content": {MEDIA_TYPE: {"schema": schema}}}
        for status in sorted({*statuses, *always})
    }


def describe_api(app: FastAPI) -> None:
    """Make `app.openapi()` complete: every problem is of the type `Problem`."""

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
            schemas["Problem"] = Problem.model_json_schema(
                ref_template="#/components/schemas/{model}"
            )
            for methods in made["paths"].values():
                for operation in methods.values():
                    if "requestBody" in operation:
                        operation["responses"].setdefault("413", problems(413)[413])
            for unused in ("HTTPValidationError", "ValidationError"):
                schemas.pop(unused, None)
            app.openapi_schema = made
        return app.openapi_schema

    app.openapi = document  # type: ignore[method-assign]  # FastAPI's own way to extend it
