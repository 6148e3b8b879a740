"""What is swept: exposures, levels, both, or blocks named one by one."""

from collections.abc import Iterator
from itertools import product
from typing import Annotated, Literal, NamedTuple

from pydantic import Field, model_validator

from calib.recording.header import BlockKind
from service.plan.part import PlanPart

ExposureUs = Annotated[float, Field(gt=0)]
FlatLevel = Annotated[float, Field(gt=0)]


class Point(NamedTuple):
    """One flat to take."""

    exposure_us: float
    level: float


class ExposureSweep(PlanPart):
    """All exposures at one level: determines offset and slope."""

    type: Literal["exposure"] = "exposure"
    exposures_us: tuple[ExposureUs, ...] = Field(min_length=1)
    level: FlatLevel
    """The number of lamps that burn, or the LED's setting."""

    def points(self) -> Iterator[Point]:
        """Yield the flats as the plan gives them."""
        return (Point(exposure_us, self.level) for exposure_us in self.exposures_us)


class LevelSweep(PlanPart):
    """All levels at one exposure: determines the radiance scale."""

    type: Literal["level"] = "level"
    levels: tuple[FlatLevel, ...] = Field(min_length=1)
    exposure_us: ExposureUs

    def points(self) -> Iterator[Point]:
        """Yield the flats as the plan gives them."""
        return (Point(self.exposure_us, level) for level in self.levels)


class Factorial(PlanPart):
    """Every exposure at every level; as given, all levels of one exposure come together."""

    type: Literal["factorial"] = "factorial"
    exposures_us: tuple[ExposureUs, ...] = Field(min_length=1)
    levels: tuple[FlatLevel, ...] = Field(min_length=1)

    def points(self) -> Iterator[Point]:
        """Yield the flats as the plan gives them."""
        return (Point(*pair) for pair in product(self.exposures_us, self.levels))


class ListedBlock(PlanPart):
    """One block, as it stands."""

    kind: BlockKind = "flat"
    exposure_us: ExposureUs
    level: float = Field(default=0.0, ge=0)
    """What burns; behind the cap of a dark too."""
    lines: int | None = Field(default=None, ge=1)
    """None: as many as the plan says."""
    wait_s: float = Field(default=0.0, ge=0)
    """Wait this long before it, the conditions already set."""
    scene: str | None = None
    """Names the scene of a block whose kind is "scene"."""

    @model_validator(mode="after")
    def _scene_is_named(self) -> "ListedBlock":
        if self.kind == "scene" and self.scene is None:
            msg = 'a block of kind "scene" needs the name of its image under scenes/: give scene'
            raise ValueError(msg)
        return self


class Listed(PlanPart):
    """Blocks one by one, darks included; order and darks of the plan do not touch them."""

    type: Literal["listed"] = "listed"
    blocks: tuple[ListedBlock, ...] = Field(min_length=1)


Sweep = Annotated[ExposureSweep | LevelSweep | Factorial | Listed, Field(discriminator="type")]
