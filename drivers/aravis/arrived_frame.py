"""A frame that came whole, before the settings read back are put beside it."""

from dataclasses import dataclass

from calib.arrays import RawLines
from drivers.ports import CameraSettings, CapturedFrame


@dataclass(frozen=True)
class ArrivedFrame:
    """Pixels and times of one frame.

    Attributes:
        dn: Of the settings' `frame_shape`, our own copy.
        frame_id: The camera's own count.
        device_timestamp_ns: The camera's clock.
        host_timestamp_ns: This machine's clock when the frame began to arrive, Unix time.
    """

    dn: RawLines
    frame_id: int
    device_timestamp_ns: int
    host_timestamp_ns: int

    def captured(self, used: CameraSettings, temperature_c: float | None) -> CapturedFrame:
        """Return the frame with what was read back from the camera."""
        return CapturedFrame(
            dn=self.dn,
            frame_id=self.frame_id,
            device_timestamp_ns=self.device_timestamp_ns,
            host_timestamp_ns=self.host_timestamp_ns,
            exposure_us=used.exposure_us,
            gain_db=used.gain_db,
            sensor_temperature_c=temperature_c,
        )
