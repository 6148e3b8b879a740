"""What every part of a bench file is: frozen, and strict about its keys."""

from pydantic import BaseModel, ConfigDict


class BenchPart(BaseModel):
    """An unknown key is an error, so that a typo cannot leave a lamp at a wrong current."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
