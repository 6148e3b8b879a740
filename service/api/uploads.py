"""Receiving a body without ever holding it in memory, and never more than is allowed."""

import tempfile
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import IO

from fastapi import Request
from starlette.concurrency import run_in_threadpool

from calib.errors import InputError
from service.api.body_limit import allow
from service.settings import Settings


async def receive(request: Request, into: IO[bytes], *, limit_bytes: int) -> int:
    """Write the request's body to `into`; return how many bytes it has.

    Raises:
        InputError: `too-large`, before or while it comes; `empty-body`.
    """
    stated = request.headers.get("content-length", "")
    if stated.isdecimal() and int(stated) > limit_bytes:
        raise _too_large(limit_bytes)
    allow(request.scope, limit_bytes)
    n_bytes = 0
    async for chunk in request.stream():
        n_bytes += len(chunk)
        if n_bytes > limit_bytes:
            raise _too_large(limit_bytes)
        await run_in_threadpool(into.write, chunk)
    if n_bytes == 0:
        raise InputError("the request has no body: send the file as it", code="empty-body")
    return n_bytes


@asynccontextmanager
async def uploaded(request: Request, media_type: str, settings: Settings) -> AsyncIterator[Path]:
    """Give the file of an uploaded body, of that type alone; it is removed afterwards.

    Raises:
        InputError: `wrong-media-type`, and as `receive`.
    """
    check_media_type(request, media_type)
    with tempfile.NamedTemporaryFile(dir=settings.work_folder) as file:
        await receive(request, file, limit_bytes=settings.max_upload_bytes)
        file.flush()
        yield Path(file.name)


def check_media_type(request: Request, *accepted: str) -> None:
    """Raise InputError `wrong-media-type` unless the body is one of `accepted`.

    None of them is a type that a browser sends to a foreign address without asking.
    """
    given = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if given not in accepted:
        msg = f"the body is {given or 'of no stated type'}; send {' or '.join(accepted)}"
        raise InputError(msg, code="wrong-media-type")


def _too_large(limit_bytes: int) -> InputError:
    return InputError(
        f"the body is larger than the {limit_bytes} bytes that this service accepts;"
        " send less, or import it on the service's own machine",
        code="too-large",
    )
