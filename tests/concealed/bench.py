"""A sensor and a block without anything of chance, for tests of single mechanisms."""

from dataclasses import replace

import numpy as np

from tests.concealed.generator.mechanism import Mechanism
from tests.concealed.generator.plan import BlockPlan, Plan
from tests.concealed.generator.scan import Scan
from tests.concealed.generator.sensor import Sensor
from tests.concealed.generator.setting import Setting

EXPOSURE_US = 1000.0


def level_sensor(rows: int = 1, columns: int = 64, layout: str = "single") -> Sensor:
    return Sensor(
        rows=rows, columns=columns, area=rows > 1, bit_depth=14, layout=layout, readout="left",
        gain_dn_per_e=0.2, read_noise_e=10.0, full_well_e=60_000.0, electrons_per_radiance_us=10.0,
        relative_response=np.ones((rows, columns)), offset_dn=np.full((rows, columns), 200.0),
    )  # fmt: skip


def scan_of(
    sensor: Sensor, n: int, *, started_s: float = 0.0, kind: str = "flat", warmth_k: float = 0.0
) -> Scan:
    block = BlockPlan("000", kind, EXPOSURE_US, 1.0, 1.0, n, started_s, 25.0 + warmth_k)
    return Scan(sensor, block, 1200.0, 10.0, 0, 1.0, EXPOSURE_US, 25.0)


def setting_of(sensor: Sensor, n: int = 100) -> Setting:
    flat = BlockPlan("000", "flat", EXPOSURE_US, 1.0, 1.0, n)
    dark = replace(flat, name="001", kind="dark", level=0.0, radiance=0.0, started_s=5.0)
    plan = Plan((flat, dark), 1200.0, "led", 1, "1", False, "random", "last", "constant")
    return Setting(sensor, plan)


def drawn(
    kind: type[Mechanism], strength: float, shape: str, sensor: Sensor, seed: int = 0
) -> Mechanism:
    rng = np.random.default_rng(seed)
    return kind.draw(strength, shape, setting_of(sensor), rng)
