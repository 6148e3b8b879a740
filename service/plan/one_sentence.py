"""A pydantic error as one sentence that names the key and what is allowed."""

from difflib import get_close_matches
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError


def one_sentence(error: ValidationError, root: type[BaseModel]) -> str:
    """Return what is wrong with the first faulty key of `root`, and how many more are."""
    # A typo leaves a missing key behind as well: the typo is what has to be said.
    faults = sorted(error.errors(), key=lambda fault: fault["type"] != "extra_forbidden")
    sentence = _fault(faults[0], root)
    more = len(faults) - 1
    return sentence + (f" ({more} more {'fault' if more == 1 else 'faults'})" if more else "")


def _fault(fault: Any, root: type[BaseModel]) -> str:
    kind, location = fault["type"], fault["loc"]
    if kind == "extra_forbidden":
        return _unknown_key(location, root)
    key = _path(location, root) or "plan"
    if kind == "missing":
        return f"{key} is missing; add it"
    if kind == "value_error":
        reason = str(fault["ctx"]["error"])
        return f"{key}: {reason}" if location else reason
    if kind == "union_tag_not_found":
        return f"{key}.{_tag_name(fault)} is missing; allowed are {_tags_at(location, root)}"
    if kind == "union_tag_invalid":
        return (
            f"{key}.{_tag_name(fault)} = {fault['ctx']['tag']!r} is unknown; allowed are"
            f" {fault['ctx']['expected_tags']}"
        )
    is_no_table = kind in {"model_type", "model_attributes_type"}
    wanted = "should be a table" if is_no_table else _lowered(fault["msg"])
    return f"{key} = {fault['input']!r}: {wanted}"


def _tag_name(fault: Any) -> str:
    """Return the key by which the members of a union are told apart, `type` or `driver`."""
    return str(fault["ctx"]["discriminator"]).strip("'")


def _unknown_key(location: tuple[str | int, ...], root: type[BaseModel]) -> str:
    key = str(location[-1])
    owner = _model_at(location[:-1], root)
    allowed = sorted(owner.model_fields) if owner else []
    near = get_close_matches(key, allowed, n=1)
    hint = f"; did you mean {near[0]}?" if near else ""
    where = _path(location, root)
    return f"{where} is an unknown key{hint} (allowed are {', '.join(allowed)})"


def _tags_at(location: tuple[str | int, ...], root: type[BaseModel]) -> str:
    """Return the tags of the union at `location`, quoted."""
    annotation: Any = root
    for item in location:
        annotation = _below(annotation, item)
    return ", ".join(repr(tag) for member in _members(annotation) for tag in _tags(member))


def _path(location: tuple[str | int, ...], root: type[BaseModel]) -> str:
    """Join the keys as TOML writes them, the tags of unions left out."""
    annotation: Any = root
    text = ""
    for item in location:
        models = [m for m in _members(annotation) if isinstance(m, type)]
        is_tag = any(item in _tags(m) for m in models)
        annotation = _below(annotation, item)
        if is_tag or item == "[key]":
            continue
        text += f"[{item}]" if isinstance(item, int) else f"{'.' if text else ''}{item}"
    return text


def _model_at(location: tuple[str | int, ...], root: type[BaseModel]) -> type[BaseModel] | None:
    annotation: Any = root
    for item in location:
        annotation = _below(annotation, item)
    models = [m for m in _members(annotation) if isinstance(m, type) and issubclass(m, BaseModel)]
    return models[0] if models else None


def _below(annotation: Any, item: str | int) -> Any:
    """Return the annotation that `item` of a location leads to; Any where it is not known."""
    for member in _members(annotation):
        if isinstance(member, type) and issubclass(member, BaseModel):
            if item in _tags(member):
                return member
            if item in member.model_fields:
                return member.model_fields[str(item)].annotation
        elif get_origin(member) in {tuple, list}:
            return get_args(member)[0]
        elif get_origin(member) is dict:
            return get_args(member)[1]
    return Any


def _members(annotation: Any) -> tuple[Any, ...]:
    if get_origin(annotation) is Annotated:
        return _members(get_args(annotation)[0])
    if get_origin(annotation) in {Union, UnionType}:
        return tuple(m for part in get_args(annotation) for m in _members(part))
    return (annotation,)


def _tags(member: Any) -> tuple[str, ...]:
    """Return the values of a model's discriminator, where it has one."""
    if not (isinstance(member, type) and issubclass(member, BaseModel)):
        return ()
    for name in ("type", "driver"):
        field = member.model_fields.get(name)
        if field is not None and get_origin(field.annotation) is Literal:
            return tuple(get_args(field.annotation))
    return ()


def _lowered(message: str) -> str:
    return message[:1].lower() + message[1:]
