"""Aravis: what cameras are spoken to with."""

from service.doctor.finding import Finding

_REMEDY = (
    "apt-get install --no-install-recommends gir1.2-aravis-0.8 libgirepository1.0-dev gcc"
    " pkg-config libcairo2-dev && pip install 'PyGObject>=3.48,<3.52'"
)


def why_no_aravis() -> str:
    """Return why cameras cannot be spoken to; empty where they can."""
    try:
        import gi  # noqa: F401, PLC0415
    except ImportError:
        return "PyGObject is not installed"
    from drivers.aravis.gi_aravis import aravis  # noqa: PLC0415
    from drivers.aravis.native import library  # noqa: PLC0415
    from drivers.errors import DeviceError  # noqa: PLC0415

    try:
        aravis()
    except DeviceError:
        return "the introspection data of Aravis 0.8 are not installed"
    try:
        library()
    except OSError as error:
        return f"libaravis cannot be loaded ({error})"
    return ""


def look_at_aravis(*, needed: bool) -> list[Finding]:
    """Return what was found about Aravis; `needed` where the bench's camera speaks by it."""
    missing = why_no_aravis()
    if missing:
        text = f"{missing}: no GigE Vision, no USB3 Vision"
        return [Finding("Aravis", "missing" if needed else "advice", text, _REMEDY)]
    return [Finding("Aravis", "ok", "0.8 with its introspection data and PyGObject")]
