"""One run of the camera: started, watched, stopped."""

import time

from drivers.aravis.arrived_frame import ArrivedFrame
from drivers.aravis.connection import Connection
from drivers.aravis.frame_stream import FrameStream, StreamOptions
from drivers.aravis.gi_errors import speaking
from drivers.aravis.stream_report import StreamReport
from drivers.errors import DeviceError, DeviceTimeoutError
from drivers.ports import CameraSettings, LostFrame


class Acquisition:
    """Sends frames from the moment it is made until `stop`.

    `patience_s` is how long the next frame may take: its own period and a time-out of ours, for
    Aravis has none.
    """

    def __init__(
        self,
        connection: Connection,
        settings: CameraSettings,
        options: StreamOptions,
        frame_timeout_s: float,
    ) -> None:
        self.settings = settings
        period_s = settings.frame_lines * settings.line_period_us * 1e-6
        self.patience_s = period_s + frame_timeout_s
        self._connection = connection
        self._stream = FrameStream(connection.camera, settings, options, connection.device)
        try:
            connection.set_locked(True)
            with speaking(connection.device, "start its acquisition"):
                connection.camera.start_acquisition()
        except DeviceError:
            self.stop()
            raise
        self._give_up_s = time.monotonic() + self.patience_s

    def next(self, timeout_s: float) -> tuple[ArrivedFrame | LostFrame, ...]:
        """Return what comes within `timeout_s`: nothing, or a frame after those lost before it.

        Raises:
            DeviceTimeoutError: Code `frame-timeout`: patience is over, though the camera answers.
            DeviceLostError: It does not.
        """
        self._connection.must_hold()
        arrived = self._stream.pop(timeout_s)
        if arrived:
            self._give_up_s = time.monotonic() + self.patience_s
        elif time.monotonic() > self._give_up_s:
            raise self._no_frame()
        return arrived

    def loss_hint(self) -> str:
        """Say what was lost on the way, and what may be done about it."""
        return self._stream.loss_hint()

    def stop(self) -> StreamReport:
        """Stop the camera where it can still hear it, close the stream; return what it counted."""
        try:
            self._connection.stop_acquisition()
        finally:
            report = self._stream.close()
        return report

    def _no_frame(self) -> DeviceError:
        """Tell a camera that is gone, or obeys another, from one that merely sends nothing."""
        device = self._connection.device
        if not self._connection.answers():
            return self._connection.lost_error("it no longer answers")
        if not self._connection.obeys():
            return self._connection.lost_error(
                "it answers but obeys no more, so another program took control of it",
                "end that program",
            )
        return DeviceTimeoutError(
            f"{device}: no frame within {self.patience_s:.1f} s, though it answers; does the "
            "firewall let its UDP stream pass, does the link carry the packet size, is a trigger "
            f"awaited? {self.loss_hint()}",
            device=device,
            code="frame-timeout",
        )
