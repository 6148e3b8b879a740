"""The bench, as the service tells it."""

from datetime import datetime
from typing import Literal

from pydantic import BaseModel, Field

from service.api.answers.job import JobError
from service.owner.messages import BenchLook, DeviceLook


class DeviceTrouble(BaseModel):
    """Why a device could not be asked."""

    code: str
    message: str
    last_exchange: str = Field(description="The last bytes exchanged with it.")


class DeviceAnswer(BaseModel):
    """One device, read back."""

    role: str = Field(examples=["light"])
    identity: str
    values: dict[str, float | str | bool | None] = Field(
        description="By name; a number's name carries its unit."
    )
    trouble: DeviceTrouble | None

    @classmethod
    def of(cls, look: DeviceLook) -> "DeviceAnswer":
        """Return the answer for a device's look."""
        trouble = None
        if look.trouble is not None:
            trouble = DeviceTrouble(
                code=look.trouble.code,
                message=look.trouble.message,
                last_exchange=look.trouble.last_exchange,
            )
        return cls(role=look.role, identity=look.identity, values=look.values, trouble=trouble)


class KeptDarkAnswer(BaseModel):
    """Who pressed safe-off, and when."""

    by: str
    since: datetime


class BenchAnswer(BaseModel):
    """The bench: what it does, and who has it."""

    id: str
    state: Literal["opening", "idle", "busy", "closed"]
    trouble: JobError | None = Field(description="Why it cannot be used.")
    run: str | None = Field(description="The run that has it.")
    held_by: str | None = Field(description="Who submitted that.")
    kept_dark: KeptDarkAnswer | None = Field(
        description="Since safe-off was pressed: runs wait until the bench is released."
    )
    devices: tuple[DeviceAnswer, ...] = Field(description="As they were when last asked.")


class LampsOff(BaseModel):
    """What was read back after every lamp was switched off."""

    dark: bool = Field(description="Whether every light reads back as off.")
    devices: tuple[DeviceAnswer, ...]

    @classmethod
    def of(cls, look: BenchLook) -> "LampsOff":
        """Return the answer for what was read back."""
        lights = [each for each in look.devices if each.role == "light"]
        dark = all(each.trouble is None for each in lights)
        return cls(dark=dark, devices=tuple(map(DeviceAnswer.of, look.devices)))
