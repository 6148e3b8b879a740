"""Asks every device of a bench how it is; one that fails or is slow does not hold up the others."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from calib.errors import DarkflatError
from drivers.ports import LightState
from service.bench.all_off import all_off
from service.bench.bench import Bench
from service.owner.messages import BenchLook, DeviceLook, Trouble

Values = dict[str, float | str | bool | None]


def look_at(bench: Bench, *, switching_off: bool = False) -> BenchLook:
    """Return how every device is, read back now, each over its own line at the same time.

    Args:
        bench: Open.
        switching_off: Whether the light is switched off before it is read.
    """

    def light() -> Values:
        return _of_light(all_off(bench.light) if switching_off else bench.light.state())

    def monitor() -> Values:
        return {} if bench.monitor is None else {"current_a": bench.monitor.read().current_a}

    def camera() -> Values:
        return {"temperature_c": bench.camera.temperature_c()}

    questions: list[tuple[str, object, Callable[[], Values]]] = [
        ("camera", bench.camera, camera),
        ("light", bench.light, light),
        ("shutter", bench.shutter, dict),
    ]
    if bench.monitor is not None:
        questions.append(("monitor", bench.monitor, monitor))
    with ThreadPoolExecutor(len(questions), "darkflat-bench-look") as asking:
        looks = asking.map(_looked, *zip(*questions, strict=True))
    return BenchLook(bench.id, tuple(looks))


def _looked(role: str, device: object, ask: Callable[[], Values]) -> DeviceLook:
    identity = getattr(device, "identity", None)
    parts = () if identity is None else (identity.vendor, identity.model, identity.serial)
    who = " ".join(part for part in parts if part)
    try:
        return DeviceLook(role, who, ask())
    except DarkflatError as error:
        return DeviceLook(role, who, {}, Trouble.of(error))


def _of_light(state: LightState) -> Values:
    values: Values = {"level": state.level}
    for number, lamp in enumerate(state.lamps, start=1):
        values[f"lamp_{number}_on"] = lamp.on
        values[f"lamp_{number}_current_a"] = lamp.current_a
        values[f"lamp_{number}_hours"] = lamp.hours
    return values
