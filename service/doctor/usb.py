"""The rule that lets a user speak to USB3 Vision cameras."""

from pathlib import Path

from service.doctor.finding import Finding

_RULE_FOLDERS = tuple(Path(each) for each in ("/etc/udev/rules.d", "/usr/lib/udev/rules.d"))
_VISION = ('ATTRS{bInterfaceClass}=="ef"', "aravis")
_REMEDY = (
    """echo 'SUBSYSTEM=="usb", ENV{ID_USB_INTERFACES}=="*:ef0500:*", MODE="0666"' |"""
    " sudo tee /etc/udev/rules.d/70-usb3-vision.rules && sudo udevadm control --reload"
)


def look_at_usb(folders: tuple[Path, ...] = _RULE_FOLDERS) -> list[Finding]:
    """Return whether a udev rule names USB3 Vision (interface class ef, subclass 05)."""
    for folder in folders:
        for rule in sorted(folder.glob("*.rules")) if folder.is_dir() else ():
            if _is_about_vision(rule):
                return [Finding("USB3 Vision", "ok", f"rule {rule}")]
    text = "no udev rule: only root can open USB3 Vision cameras (GigE Vision needs none)"
    return [Finding("USB3 Vision", "advice", text, _REMEDY)]


def _is_about_vision(rule: Path) -> bool:
    if "aravis" in rule.name:
        return True
    try:
        text = rule.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return False
    return "ef0500" in text or any(sign in text for sign in _VISION)
