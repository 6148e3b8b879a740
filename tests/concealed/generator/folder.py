"""A recording as a folder that tells nothing of what is hidden in it."""

import csv
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
from numpy.random import Generator

from tests.concealed.generator.chain import TakenBlock
from tests.concealed.generator.plan import BlockPlan, Plan
from tests.concealed.generator.sensor import Sensor

_COLUMNS = ("block", "kind", "exposure_us", "level", "started_s", "sensor_temperature_c",
            "lines", "radiance")  # fmt: skip


def write_folder(
    folder: Path, sensor: Sensor, plan: Plan, taken: Iterable[TakenBlock], rng: Generator
) -> None:
    """Write recording.toml, conditions.csv and frames/ into `folder`, which must not be there.

    `rng` draws the serial number, the date and the instruments' own errors: it must have no part
    in what is hidden.
    """
    (folder / "frames").mkdir(parents=True)
    (folder / "recording.toml").write_text(_header(sensor, plan, rng), encoding="utf-8")
    per_radiance_a = 10.0 ** rng.uniform(-8.0, -6.0)
    dark_a = abs(rng.standard_normal()) * 1e-4 * per_radiance_a * plan.flats[0].radiance
    rows, scene = [], any(block.image for block in plan.blocks)
    for block in taken:
        if block.plan.image:
            (folder / "scenes").mkdir(exist_ok=True)
            radiance = block.plan.radiance * np.array(block.plan.image)
            np.save(folder / "scenes" / "bars.npy", radiance[np.newaxis])
        codes = block.codes if sensor.area else block.codes[:, 0, :]
        np.save(folder / "frames" / f"{block.plan.name}.npy", np.ascontiguousarray(codes))
        light_a = per_radiance_a * block.source_radiance * (1.0 + 2e-5 * rng.standard_normal())
        row = _row(block.plan, rng)
        row += [f"{dark_a + light_a:.7g}"] if plan.monitor else []
        rows.append(row + (["bars" if block.plan.image else ""] if scene else []))
    columns = [*_COLUMNS, *(["monitor"] if plan.monitor else []), *(["scene"] if scene else [])]
    _write_conditions(folder / "conditions.csv", columns, rows)


def _row(plan: BlockPlan, rng: Generator) -> list[str]:
    temperature = plan.temperature_c + 0.02 * rng.standard_normal()
    return [plan.name, plan.kind, f"{plan.exposure_us:.1f}", f"{plan.level:g}",
            f"{plan.started_s:.3f}", f"{temperature:.2f}", str(plan.n_samples),
            repr(plan.radiance)]  # fmt: skip


def _write_conditions(path: Path, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(rows)


def _header(sensor: Sensor, plan: Plan, rng: Generator) -> str:
    day = datetime(2026, 1, 5, 8, tzinfo=UTC) + timedelta(minutes=int(rng.integers(0, 300_000)))
    kind = "A" if sensor.area else "L"
    camera = {
        "model": f'"{kind}{sensor.columns}-{sensor.bit_depth}"',
        "serial": f'"{int(rng.integers(10_000, 99_999))}"',
        "columns": sensor.columns,
        **({"rows": sensor.rows} if sensor.area else {}),
        "bit_depth": sensor.bit_depth,
        "gain_db": 0.0,
        "taps": sensor.n_taps,
        "tap_layout": f'"{sensor.layout}"',
        "readout": f'"{sensor.readout}"',
        "line_period_us": plan.line_period_us,
        "band": f'"{rng.choice(["NIR", "red", "green", "blue"])}"',
        "started_at": f'"{day:%Y-%m-%dT%H:%M:%SZ}"',
    }
    source = {
        "kind": f'"{plan.source}"',
        "lamps": plan.lamps,
        "radiance_unit": f'"{plan.radiance_unit}"',
    }
    return "\n".join(
        ["[camera]", *(f"{name} = {value}" for name, value in camera.items()),
         "[source]", *(f"{name} = {value}" for name, value in source.items()), ""]
    )  # fmt: skip
