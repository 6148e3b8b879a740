"""A model file in a request: its text."""

from typing import Annotated

from pydantic import Field

ModelText = Annotated[str, Field(max_length=1 << 24)]


def check_model(text: str | None) -> None:
    """Raise what the model file's reader says of it; None is no model."""
    if text is None:
        return
    from calib.forward.model import Model  # noqa: PLC0415  (slow to import)

    Model.loads(text)
