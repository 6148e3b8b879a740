"""`recording.toml`: the camera and the source, as text that keeps every type TOML knows."""

import tomllib
from collections.abc import Iterator
from typing import Any

import tomli_w
from pydantic import BaseModel, ValidationError

from calib.errors import InputError
from calib.recording.header import Block, RecordingHeader


def header_to_toml(header: RecordingHeader) -> str:
    """Return `header` without its blocks; unknown keys included, unknown values left out."""
    content = header.model_dump(exclude={"blocks"}, exclude_none=True)
    if header.camera.started_at is not None:  # a string, as the interchange format has it
        content["camera"]["started_at"] = header.camera.model_dump(mode="json")["started_at"]
    return tomli_w.dumps(_without_none(content))


def header_from_toml(
    text: str, blocks: tuple[Block, ...], where: str
) -> tuple[RecordingHeader, tuple[str, ...]]:
    """Return the header and a warning for every unknown key; `where` is named in errors."""
    try:
        content = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(
            f"{where} is not TOML ({error}): correct it", code="header-invalid"
        ) from error
    try:
        header = RecordingHeader.model_validate({**content, "blocks": blocks})
    except ValidationError as error:
        raise InputError(f"{where}: {first_problem(error)}", code="header-invalid") from error
    return header, tuple(f"{where}: unknown key {key} is kept" for key in _unknown_keys(header))


def first_problem(error: ValidationError) -> str:
    """Return the first of pydantic's findings as one phrase: where, what, what came instead."""
    first = error.errors()[0]
    where = ".".join(str(part) for part in first["loc"])
    if first["type"] == "missing":
        return f"{where} is missing: add it"
    if first["type"] == "timezone_aware":
        return f"{where} = {first['input']} has no time zone: write it in UTC, with a Z at its end"
    return f"{where} = {first['input']!r} cannot be: {first['msg'][0].lower()}{first['msg'][1:]}"


def _unknown_keys(header: RecordingHeader) -> Iterator[str]:
    parts: tuple[tuple[str, BaseModel], ...] = (
        ("", header),
        ("camera.", header.camera),
        ("source.", header.source),
    )
    for prefix, part in parts:
        for key in part.model_extra or {}:
            yield prefix + key


def _without_none(value: Any) -> Any:  # TOML's values are of any type
    if isinstance(value, dict):
        return {key: _without_none(each) for key, each in value.items() if each is not None}
    return value
