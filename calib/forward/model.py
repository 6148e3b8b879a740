"""The forward model: a camera, a source, and the chain of effects between light and DN."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from numpy.random import Generator

from calib.arrays import Lines
from calib.errors import InputError, reason_of
from calib.forward import model_file
from calib.forward.conditions import Conditions
from calib.forward.draw import draw
from calib.forward.drawn import Drawn
from calib.forward.effect import Effect
from calib.forward.effects.catalogue import effect_named, place_of
from calib.forward.pattern import pixel_count
from calib.forward.remembering import Remembering
from calib.forward.scene import as_scene
from calib.forward.truth import Truth
from calib.forward.truth_of import truth_of
from calib.forward.uncertainty import check_uncertainty
from calib.recording.frame_codes import sample_shape
from calib.recording.header import CameraHeader, SourceHeader

REQUIRED = ("responsivity", "system_gain", "adc")
"""The links that change the unit: no chain gets from light to codes without them."""
MOST_PIXELS = 1 << 28
"""Of a frame; what belongs to a pixel is kept for each of them."""


@dataclass(frozen=True)
class Model:
    """Radiance goes in, raw DN come out.

    DN = clip(round(K (min(Poisson(expected electrons), full well) + read noise) + DN0)), where
    expected electrons = radiance x t x VE x responsivity + dark current x t, and the links of the
    catalogue bend each step of it.

    Attributes:
        camera: Size, bit depth, taps, and how it is set.
        source: The light.
        effects: The links; kept in the physical order, each name once.
        uncertainty: Standard uncertainties of links' parameters, by link and parameter, where
            somebody determined them; drawing takes no notice of them.
    """

    camera: CameraHeader
    source: SourceHeader
    effects: tuple[Effect, ...]
    uncertainty: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Put the links in order; raise InputError where they do not make a chain."""
        ordered = tuple(sorted(self.effects, key=place_of))
        object.__setattr__(self, "effects", ordered)
        names = [effect.name for effect in ordered]
        for name in names:
            if names.count(name) > 1:
                raise InputError(f"effect {name} is there twice; keep one.", code="effect-twice")
        for name in REQUIRED:
            if name not in names:
                raise InputError(
                    f"effect {name} is missing; add it, for light cannot become codes without it.",
                    code="effect-missing",
                )
        if pixel_count(self.camera) > MOST_PIXELS:
            raise InputError(
                f"camera: {self.camera.rows} rows of {self.camera.columns} columns are more than "
                f"{MOST_PIXELS} pixels; give fewer.",
                code="too-many-pixels",
            )
        for effect in ordered:
            effect.check_camera(self.camera)
        check_uncertainty(self.uncertainty, ordered)

    @classmethod
    def loads(cls, text: str, *, where: str = "model") -> "Model":
        """Return the model of a TOML text; `where` names it in errors."""
        parts = model_file.parse(text, where)
        try:
            return cls(*parts)
        except InputError as error:
            raise InputError(f"{where}: {error}", code=error.code) from error

    @classmethod
    def load(cls, path: Path | str) -> "Model":
        """Return the model of the file at `path`."""
        try:
            text = Path(path).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            msg = (
                f"{path} cannot be read ({reason_of(error)}): give a model file or a preset's name."
            )
            raise InputError(msg, code="unreadable") from error
        return cls.loads(text, where=str(path))

    @classmethod
    def preset(cls, name: str) -> "Model":
        """Return a model that comes with darkflat: `model_file.preset_names()` lists them."""
        return cls.loads(model_file.preset_text(name), where=f"preset {name}")

    @classmethod
    def named(cls, text: str) -> "Model":
        """Return the preset of that name, or the model of that file: `model_file.is_preset_name`.

        The one rule for a model that somebody names in a command, an option or a bench file.
        """
        return cls.preset(text) if model_file.is_preset_name(text) else cls.load(text)

    def dumps(self) -> str:
        """Return the model as TOML; `loads` gives the same model back."""
        return model_file.text_of(self.camera, self.source, self.effects, self.uncertainty)

    def save(self, path: Path | str) -> None:
        """Write the model to `path`, whole or not at all."""
        target = Path(path)
        partial = target.with_name(target.name + ".partial")
        with partial.open("w", encoding="utf-8") as file:
            file.write(self.dumps())
            file.flush()
            os.fsync(file.fileno())
        partial.replace(target)

    def effect(self, name: str) -> Effect | None:
        """Return the link of that name, None where the chain lacks it."""
        effect_named(name)
        return next((effect for effect in self.effects if effect.name == name), None)

    def with_effect(self, effect: Effect) -> "Model":
        """Return the model with `effect` added, or in place of the one of that name."""
        others = tuple(e for e in self.effects if e.name != effect.name)
        return replace(self, effects=(*others, effect))

    def without(self, name: str) -> "Model":
        """Return the model without the effect of that name, if it has it."""
        effect_named(name)
        kept = tuple(e for e in self.effects if e.name != name)
        known = {n: stds for n, stds in self.uncertainty.items() if n != name}
        return replace(self, effects=kept, uncertainty=known)

    @property
    def remembers(self) -> bool:
        """Whether lines depend on what earlier ones left in the pixels."""
        return any(isinstance(effect, Remembering) for effect in self.effects)

    def draw(self, at: Conditions, rng: Generator, scene: Lines | None = None) -> Drawn:
        """Return `at.n_lines` lines, or frames of an area sensor.

        Args:
            at: The conditions; `at.lamps` hold what each lamp emits now.
            rng: Where the randomness comes from; the same state gives the same lines.
            scene: Radiance that comes on top of the lamps', (n_lines, *sample) or one sample for
                all; none where not given. A cap shuts it out, too.
        """
        radiance = as_scene(scene, at.n_lines, sample_shape(self.camera))
        return draw(self.effects, radiance, at, rng, self.camera.bit_depth)

    def truth(self) -> Truth:
        """Return the coefficients that calibration should find, at the camera's settings."""
        return truth_of({effect.name: effect for effect in self.effects}, self.camera)
