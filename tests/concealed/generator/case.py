"""A case of the suite, and everything that follows from its seed."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.random import Generator, SeedSequence, default_rng

from tests.concealed.generator.catalogue import ALL, LISTED
from tests.concealed.generator.mechanism import Mechanism, strength_at
from tests.concealed.generator.plan import DARKS, ORDERS, draw_plan
from tests.concealed.generator.sensor import draw_sensor
from tests.concealed.generator.setting import Setting

_MOST_DRAWS = 500


@dataclass(frozen=True)
class Hidden:
    """An effect to hide: its name, its shape, and its strength's rung, 0 … 1."""

    name: str
    shape: str
    rung: float

    @property
    def listed(self) -> bool:
        """Whether a diagnosis has a name for it."""
        return self.name in LISTED

    @property
    def known_shape(self) -> bool:
        """Whether catalogues have it in this shape."""
        return self.listed and self.shape in ALL[self.name].shapes


@dataclass(frozen=True)
class Case:
    """What to hide, and the seed of all that is drawn.

    Sensor and plan come from the same distribution whatever is hidden, drawn anew until they
    could show it: a plan tells no more than that.
    """

    number: int
    kind: str
    hidden: tuple[Hidden, ...]
    seed: int
    most_pixels: int

    @cached_property
    def setting(self) -> Setting:
        """Sensor and plan."""
        rng = self.rng("setting")
        for _ in range(_MOST_DRAWS):
            setting = _draw_setting(rng, self.most_pixels)
            if all(ALL[one.name].can_show(setting) for one in self.hidden):
                return setting
        raise ValueError(f"case {self.number}: no plan can show {self.hidden}")

    @cached_property
    def mechanisms(self) -> tuple[Mechanism, ...]:
        """What is hidden, at its strength."""
        drawn = []
        for place, one in enumerate(self.hidden):
            kind = ALL[one.name]
            strength = strength_at(kind.reach(self.setting), one.rung)
            rng = self.rng(f"mechanism {place}")
            drawn.append(kind.draw(strength, one.shape, self.setting, rng))
        return tuple(drawn)

    def rng(self, purpose: str) -> Generator:
        """Return the generator of one purpose; purposes do not depend on each other."""
        words = np.frombuffer(purpose.encode().ljust(64), dtype=np.uint8)
        return default_rng(SeedSequence([self.seed, *words.tolist()]))


def _draw_setting(rng: Generator, most_pixels: int) -> Setting:
    area = bool(rng.random() < 0.25)
    layouts = ["single", "quadrants"] if area else ["single", "odd_even", "halves", "quarters"]
    layout = str(rng.choice(layouts))
    bit_depth = int(rng.choice([8, 10, 12, 14, 16], p=[0.1, 0.2, 0.4, 0.15, 0.15]))
    sensor = draw_sensor(rng, area=area, layout=layout, bit_depth=bit_depth)
    order = str(rng.choice(ORDERS, p=[0.2, 0.15, 0.4, 0.25]))
    darks = str(rng.choice(DARKS, p=[0.5, 0.2, 0.15, 0.15]))
    return Setting(
        sensor, draw_plan(sensor, rng, most_pixels=most_pixels, order=order, darks=darks)
    )
