"""A camera in words."""

from calib.recording.header import CameraHeader


def camera_name(camera: CameraHeader) -> str:
    """Return model, serial number and band, as far as they are known."""
    parts = (camera.model, camera.serial, camera.band)
    return " ".join(part for part in parts if part) or "an unnamed camera"


def camera_line(camera: CameraHeader) -> str:
    """Return how the camera was set."""
    taps = f"{camera.taps} taps ({camera.tap_layout})" if camera.taps > 1 else "1 tap"
    return f"{camera.columns} columns, {camera.bit_depth} bits, {taps}, gain {camera.gain_db:g} dB"
