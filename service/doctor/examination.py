"""Looks at everything, one after the other."""

from pathlib import Path

from calib.errors import DarkflatError
from service.doctor.aravis import look_at_aravis, why_no_aravis
from service.doctor.finding import Finding
from service.doctor.network import look_at_network
from service.doctor.python import look_at_python
from service.doctor.serial_ports import look_at_serial
from service.doctor.storage import look_at_storage
from service.doctor.usb import look_at_usb
from service.settings import Settings


def examine(bench: Path | None, settings: Settings) -> tuple[Finding, ...]:
    """Return all findings about this machine and, where one is named, about the bench."""
    found = look_at_python()
    if any(finding.state == "missing" for finding in found):
        return tuple(found)  # without the packages nothing else can be looked at
    about_bench, needs_aravis = _bench(bench)
    found += look_at_aravis(needed=needs_aravis)
    found += look_at_serial()
    found += look_at_usb()
    found += look_at_network()
    found += look_at_storage(settings, Path.cwd())
    return (*found, *about_bench)


def _bench(path: Path | None) -> tuple[list[Finding], bool]:
    """Return what the bench answers, and whether its camera needs Aravis."""
    if path is None:
        return [], False
    from service.bench.settings import BenchSettings  # noqa: PLC0415
    from service.doctor.bench import look_at_bench  # noqa: PLC0415

    try:
        settings = BenchSettings.load(path)
    except DarkflatError as error:
        return [Finding("bench file", "missing", str(error), "correct the file")], False
    needs_aravis = settings.camera.driver == "aravis"
    if needs_aravis and why_no_aravis():
        text = "not asked: its camera needs Aravis"
        return [Finding(f"bench {settings.id}", "missing", text, "install Aravis first")], True
    return look_at_bench(settings), needs_aravis
