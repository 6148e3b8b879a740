"""What every part of a plan is: frozen, and strict about its keys."""

from pydantic import BaseModel, ConfigDict


class PlanPart(BaseModel):
    """An unknown key is an error, so that a typo in a plan cannot change what is measured."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
