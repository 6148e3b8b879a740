"""The presets' cameras with as many columns as a benchmark wants."""

import tomllib
from typing import Any

import tomli_w

from calib.forward.model import Model


def camera_model(preset: str, n_columns: int) -> Model:
    """Return the preset with `n_columns`, its axis moved in proportion."""
    content: dict[str, Any] = tomllib.loads(Model.preset(preset).dumps())
    vignette = content["effects"]["vignette"]
    vignette["axis_column"] *= n_columns / content["camera"]["columns"]
    content["camera"]["columns"] = n_columns
    return Model.loads(tomli_w.dumps(content))
