"""The plan: one file that a bench, a simulation and a diagnosis understand."""

import hashlib
import json
import tomllib
from itertools import islice
from math import ceil
from pathlib import Path
from typing import Any

import tomli_w
from pydantic import Field, ValidationError, model_validator

from calib.errors import InputError, reason_of
from service.plan.camera import PlanCamera
from service.plan.darks import Darks, DarksField
from service.plan.interlocks import Interlocks
from service.plan.lamps import LampUse
from service.plan.one_sentence import one_sentence
from service.plan.order import AsGiven, Order
from service.plan.part import PlanPart
from service.plan.saturation import SaturationLookAhead
from service.plan.settle import Settle
from service.plan.source import PlanSource
from service.plan.sweeps import Listed, Sweep

_LONGEST_FRAME = 512
MOST_BLOCKS = 100_000
"""Weeks of measuring; more is a slip of the pen that would ask for all memory."""


class Plan(PlanPart):
    """What to measure. See `service.plan.expand` for the blocks that it stands for."""

    name: str = "sweep"
    sweep: Sweep
    camera: PlanCamera
    source: PlanSource = PlanSource()
    lines: int = Field(ge=1)
    """Per block."""
    frame_lines: int | None = Field(default=None, ge=1)
    """Lines per frame; must divide the lines of every block. None: chosen (`lines_per_frame`)."""
    repeats: int = Field(default=1, ge=1)
    """How often the whole sweep is taken."""
    order: Order = AsGiven()
    darks: DarksField = Darks()
    lamps: LampUse = LampUse()
    settle: Settle = Settle()
    saturation: SaturationLookAhead = SaturationLookAhead()
    interlocks: Interlocks = Interlocks()

    @classmethod
    def load(cls, path: Path) -> "Plan":
        """Read a .toml or .json plan; raises InputError with code `plan-invalid`."""
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            msg = (
                f"{path} cannot be read as a plan ({reason_of(error)}); give a .toml or .json file"
            )
            raise InputError(msg, code="plan-unreadable") from error
        return cls.loads(text, where=str(path), json_text=path.suffix.lower() == ".json")

    @classmethod
    def loads(cls, text: str, *, where: str = "the plan", json_text: bool = False) -> "Plan":
        """Read a plan from TOML, or JSON where `json_text`; `where` names it in errors."""
        try:
            content = json.loads(text) if json_text else tomllib.loads(text)
        except (ValueError, RecursionError) as error:
            kind = "JSON" if json_text else "TOML"
            msg = f"{where} is not valid {kind} ({error}); correct it"
            raise InputError(msg, code="plan-invalid") from error
        return cls.parse(content, where=where)

    @classmethod
    def parse(cls, content: Any, *, where: str = "the plan") -> "Plan":
        """Check a plan that is already a mapping, e.g. the body of a request."""
        try:
            return cls.model_validate(content)
        except ValidationError as error:
            raise InputError(f"{where}: {one_sentence(error, cls)}", code="plan-invalid") from error

    def dumps(self) -> str:
        """Return the plan as TOML; reading it back gives the same plan."""
        return tomli_w.dumps(self.model_dump(mode="json", exclude_none=True))

    def digest(self) -> str:
        """Return the SHA-256 of its canonical JSON; two plans are the same if this is."""
        canonical = json.dumps(self.model_dump(mode="json"), sort_keys=True, allow_nan=False)
        return hashlib.sha256(canonical.encode()).hexdigest()

    @property
    def lines_per_frame(self) -> int:
        """How many lines travel together: `frame_lines`, or a divisor of all blocks' lines.

        The longest divisor up to 512; the whole block where the only ones are under 16.
        """
        if self.frame_lines is not None:
            return self.frame_lines
        lines = self._all_lines()
        longest = min(_LONGEST_FRAME, *lines)
        for length in range(longest, 15, -1):
            if all(n % length == 0 for n in lines):
                return length
        return lines[0] if len(set(lines)) == 1 else 1

    @model_validator(mode="after")
    def _not_too_many_blocks(self) -> "Plan":
        if self._n_blocks() > MOST_BLOCKS:
            msg = f"it stands for more than {MOST_BLOCKS} blocks; split it, or lower repeats"
            raise ValueError(msg)
        return self

    @model_validator(mode="after")
    def _whole_frames(self) -> "Plan":
        for lines in self._all_lines():
            if self.frame_lines is not None and lines % self.frame_lines:
                msg = f"frame_lines = {self.frame_lines} does not divide {lines} lines of a block"
                raise ValueError(msg)
        return self

    @model_validator(mode="after")
    def _exposures_fit(self) -> "Plan":
        longest = max(self.exposures_us())
        if longest > self.camera.line_period_us:
            msg = (
                f"an exposure of {longest:g} µs is longer than camera.line_period_us ="
                f" {self.camera.line_period_us:g}; shorten it, or make the period longer"
            )
            raise ValueError(msg)
        return self

    @model_validator(mode="after")
    def _levels_exist(self) -> "Plan":
        highest = max(self.levels())
        lamps = self.source.lamps
        if self.source.kind == "sphere" and lamps is not None and highest > lamps:
            msg = f"level {highest:g} needs more than source.lamps = {lamps}; correct one of them"
            raise ValueError(msg)
        return self

    def exposures_us(self) -> tuple[float, ...]:
        """Return the exposures of the sweep, each once, in the order of first use."""
        return tuple(dict.fromkeys(exposure_us for exposure_us, _ in self._conditions()))

    def levels(self) -> tuple[float, ...]:
        """Return the levels of the sweep, each once, in the order of first use."""
        return tuple(dict.fromkeys(level for _, level in self._conditions()))

    @property
    def lamp_count(self) -> int:
        """How many lamps the source has; as many as the highest level needs where unsaid."""
        return ceil(max(self.levels())) if self.source.lamps is None else self.source.lamps

    def _n_blocks(self) -> int:
        """Return how many blocks there are, or a number above `MOST_BLOCKS`."""
        if isinstance(self.sweep, Listed):
            return self.repeats * len(self.sweep.blocks)
        n_flats = sum(1 for _ in islice(self.sweep.points(), MOST_BLOCKS + 1))
        if n_flats > MOST_BLOCKS or self.darks.placement == "none":
            return self.repeats * n_flats
        return self.repeats * (n_flats + self.darks.per_exposure * len(self.exposures_us()))

    def _conditions(self) -> list[tuple[float, float]]:
        if isinstance(self.sweep, Listed):
            return [(block.exposure_us, block.level) for block in self.sweep.blocks]
        return [(point.exposure_us, point.level) for point in self.sweep.points()]

    def _all_lines(self) -> list[int]:
        if isinstance(self.sweep, Listed):
            return [block.lines or self.lines for block in self.sweep.blocks]
        return [self.lines]
