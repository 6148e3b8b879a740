"""Model files: the camera, the source and the effects in TOML.

[camera]            as in recording.toml
[source]            as in recording.toml
[effects.vignette]  one table per effect, its parameters by name
[uncertainty.lag]   optional: standard uncertainties of an effect's parameters, by name
"""

import os
import tomllib
from importlib.resources import files
from pathlib import PurePath
from typing import TypeVar

import tomli_w
from pydantic import ValidationError

from calib.errors import InputError
from calib.forward.effect import Effect
from calib.forward.effects.catalogue import effect_named
from calib.forward.parameter import from_table, to_table
from calib.forward.uncertainty import Uncertainty, read_uncertainty
from calib.recording.header import CameraHeader, SourceHeader

Header = TypeVar("Header", CameraHeader, SourceHeader)
_TABLES = ("camera", "source", "effects", "uncertainty")


def parse(
    text: str, where: str
) -> tuple[CameraHeader, SourceHeader, tuple[Effect, ...], Uncertainty]:
    """Return what a model file says; `where` names the file in InputErrors."""
    try:
        document = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(f"{where} is not TOML ({error}): correct it.", code="not-toml") from error
    _only_known(document, _TABLES, where)
    camera = _header(CameraHeader, document, "camera", where)
    source = _header(SourceHeader, document, "source", where)
    effects = []
    for name, table in _table(document, "effects", where).items():
        inside = f"{where}: [effects.{name}]"
        if not isinstance(table, dict):
            raise InputError(f"{inside} is not a table; give one.", code="wrong-type")
        effects.append(from_table(effect_named(name), table, inside))
    return camera, source, tuple(effects), read_uncertainty(document, where)


def text_of(
    camera: CameraHeader,
    source: SourceHeader,
    effects: tuple[Effect, ...],
    uncertainty: Uncertainty,
) -> str:
    """Return the model file of these parts."""
    told = {name: dict(stds) for name, stds in uncertainty.items()}
    return tomli_w.dumps(
        {
            "camera": camera.model_dump(exclude_none=True),
            "source": source.model_dump(exclude_none=True),
            "effects": {effect.name: to_table(effect) for effect in effects},
            **({"uncertainty": told} if told else {}),
        }
    )


def is_preset_name(text: str) -> bool:
    """Tell whether `text` names a preset: it has no ending and no folder, whatever files there are.

    So a file or folder that happens to be called like a preset never takes its place.
    """
    return PurePath(text).suffix == "" and not {"/", os.sep}.intersection(text)


def preset_names() -> tuple[str, ...]:
    """Return the models that come with darkflat."""
    folder = files("calib.forward").joinpath("presets")
    names = (entry.name for entry in folder.iterdir())
    return tuple(sorted(name.removesuffix(".toml") for name in names if name.endswith(".toml")))


def preset_text(name: str) -> str:
    """Return the model file of the preset `name`; InputError naming all where there is none."""
    if name not in preset_names():
        raise InputError(
            f"unknown preset {name!r}; allowed: {', '.join(preset_names())};"
            f" a model file has an ending, or is named with its folder.",
            code="unknown-preset",
        )
    return files("calib.forward").joinpath("presets", f"{name}.toml").read_text(encoding="utf-8")


def _only_known(table: dict[str, object], allowed: tuple[str, ...], where: str) -> None:
    for key in table:
        if key not in allowed:
            raise InputError(
                f"{where}: unknown key {key!r}; allowed: {', '.join(allowed)}.", code="unknown-key"
            )


def _table(document: dict[str, object], key: str, where: str) -> dict[str, object]:
    table = document.get(key, {})
    if not isinstance(table, dict):
        raise InputError(f"{where}: {key!r} is not a table; write [{key}].", code="wrong-type")
    return table


def _header(kind: type[Header], document: dict[str, object], key: str, where: str) -> Header:
    table = _table(document, key, where)
    fields = tuple(kind.model_fields)
    _only_known(table, fields, f"{where}: [{key}]")
    try:
        return kind.model_validate(table)
    except ValidationError as error:
        first = error.errors()[0]
        name = ".".join(str(part) for part in first["loc"])
        if first["type"] == "missing":
            problem = "is missing: add it"
        else:
            problem = f"= {first['input']!r}: {first['msg'][:1].lower()}{first['msg'][1:]}"
        raise InputError(f"{where}: [{key}] {name} {problem}.", code="bad-header") from error
