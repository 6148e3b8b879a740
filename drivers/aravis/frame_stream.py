"""One acquisition's stream: its buffers, and what comes out of them."""

from dataclasses import dataclass
from math import ceil, prod

from drivers.aravis.arrived_frame import ArrivedFrame
from drivers.aravis.frame_ids import FrameIds
from drivers.aravis.gi_aravis import aravis, new_buffer
from drivers.aravis.gi_errors import speaking
from drivers.aravis.gi_types import GiBuffer, GiCamera, GiStream
from drivers.aravis.native import received_bytes
from drivers.aravis.receive_buffer import limit_bytes, widen
from drivers.aravis.stream_report import StreamReport
from drivers.aravis.unpack import ByteOrder, unpacked, warm_up
from drivers.errors import DeviceError
from drivers.pixel_formats import BY_PFNC, FORMATS
from drivers.ports import CameraSettings, LostFrame

SOCKET_BUFFER_BYTES = 1 << 26
"""Only where the process may not open packet sockets, which have buffers of their own."""


_BUFFERS_AT_LEAST, _BUFFER_BYTES = 16, 1 << 27


def buffers_for(settings: CameraSettings, payload: int) -> int:
    """Return how many frames of `payload` bytes may wait: those of one second.

    So long may a busy machine leave the consumer asleep. Not more than 128 MB, but 16 in any case.
    """
    per_second = ceil(1e6 / (settings.frame_lines * settings.line_period_us))
    return max(_BUFFERS_AT_LEAST, min(per_second, _BUFFER_BYTES // payload))


@dataclass(frozen=True)
class StreamOptions:
    """How to receive.

    Attributes:
        packet_size: GigE Vision, bytes; None takes the largest that the link carries, found by
            test packets, where the camera can send them, else the camera's own.
        n_buffers: Frames that may wait for the consumer; None: see `buffers_for`.
        byte_order: Of two-byte pixels.
    """

    packet_size: int | None = None
    n_buffers: int | None = None
    byte_order: ByteOrder = "little"


class FrameStream:
    """Opened anew for each acquisition: the buffers always fit, and no stale frame is in them."""

    def __init__(
        self, camera: GiCamera, settings: CameraSettings, options: StreamOptions, device: str
    ) -> None:
        self._camera = camera
        self._settings = settings
        self._options = options
        self._device = device
        self._ids = FrameIds()
        self._underruns = 0
        self._damage_without_id = ""
        self._foreign = 0
        self._payload = self._checked_payload()
        warm_up(FORMATS[settings.pixel_format])
        self._stream = self._created()
        for _ in range(options.n_buffers or buffers_for(settings, self._payload)):
            self._stream.push_buffer(new_buffer(self._payload))

    def pop(self, timeout_s: float) -> tuple[ArrivedFrame | LostFrame, ...]:
        """Return the next frame, after those that were skipped before it.

        Nothing, where none came in time, or one that cannot be named before the next one comes.

        The pixels are copied out and the buffer goes back at once.
        """
        buffer = self._stream.timeout_pop_buffer(round(timeout_s * 1e6))
        if buffer is None:
            return ()
        try:
            return self._judged(buffer)
        finally:
            self._stream.push_buffer(buffer)

    def report(self) -> StreamReport:
        """Return what was counted since the stream was opened."""
        return StreamReport.read(self._stream)

    def loss_hint(self) -> str:
        """Say what was lost on the way, and what may be done about it."""
        report, limit = self.report(), limit_bytes()
        counted = (
            f"{report.missing_packets} packets missing after {report.resend_requests} resend "
            f"requests, {report.underruns} without a free buffer"
        )
        if self._foreign:
            counted = f"{counted}, {self._foreign} that are no part of a frame"
        if report.missing_packets and limit is not None and limit < self._payload:
            return f"{counted}; a frame is larger than the kernel's net.core.rmem_max of {limit}"
        return counted

    def close(self) -> StreamReport:
        """Stop receiving, give the buffers back; return what was counted."""
        report = self.report()
        del self._stream  # the last reference: its thread ends and its buffers are freed
        return report

    def _checked_payload(self) -> int:
        """Return the bytes of a frame; a buffer of fewer would come back as a truncated success."""
        settings = self._settings
        needed = FORMATS[settings.pixel_format].n_bytes(prod(settings.frame_shape))
        with speaking(self._device, "read the payload size"):
            payload = self._camera.get_payload()
        if payload < needed:
            raise DeviceError(
                f"{self._device}: says a frame takes {payload} bytes, but {settings.n_columns} x "
                f"{settings.frame_shape[0]} pixels of {settings.pixel_format} take {needed}",
                device=self._device,
                code="payload-too-small",
            )
        return payload

    def _created(self) -> GiStream:
        module = aravis()
        gige = self._camera.is_gv_device()
        with speaking(self._device, "open its stream"):
            if gige:
                self._set_packet_size()
            stream = self._camera.create_stream(None, None)
        if stream is None:
            raise DeviceError(
                f"{self._device}: cannot open its stream", device=self._device, code="no-stream"
            )
        if gige:
            # AUTO takes the size of a frame, which is too small: the kernel counts the memory of
            # a packet, up to twice its bytes. It lowers what is asked for to net.core.rmem_max.
            stream.set_property("socket-buffer", module.GvStreamSocketBuffer.FIXED)
            stream.set_property("socket-buffer-size", SOCKET_BUFFER_BYTES)
            widen(stream.get_port(), SOCKET_BUFFER_BYTES)
        return stream

    def _set_packet_size(self) -> None:
        """Before the stream is created: Aravis lays it out for that size."""
        adjustment = aravis().GvPacketSizeAdjustment
        if self._options.packet_size is None:
            self._camera.gv_set_packet_size_adjustment(adjustment.ALWAYS)
        else:
            self._camera.gv_set_packet_size_adjustment(adjustment.NEVER)
            self._camera.gv_set_packet_size(self._options.packet_size)

    def _judged(self, buffer: GiBuffer) -> tuple[ArrivedFrame | LostFrame, ...]:
        """Say what came in `buffer`.

        One that nothing was written into is no frame: Aravis spends it on a packet that it cannot
        read. Its packet socket hears all that the machine hears until its filter is attached.
        """
        frame_id = buffer.get_frame_id()
        status = buffer.get_status()
        if status == aravis().BufferStatus.CLEARED:
            self._foreign += 1
            return ()
        is_whole = status == aravis().BufferStatus.SUCCESS
        damage = "" if is_whole else str(getattr(status, "value_nick", status))
        if damage and not self._ids.may_be_next(frame_id):
            return self._without_id(damage)
        skipped = self._ids.missing_before(frame_id)
        missing = self._why_missing(len(skipped))
        before = tuple(LostFrame(each, missing) for each in skipped)
        if self._ids.was_missed(frame_id):  # named lost already; time has gone on without it
            return before
        return (*before, LostFrame(frame_id, damage) if damage else self._frame(buffer, frame_id))

    def _without_id(self, damage: str) -> tuple[LostFrame, ...]:
        """Its id shows as a gap once the next frame comes; before the first one nothing would."""
        if not self._ids.started:
            return (LostFrame(None, damage),)
        self._damage_without_id = damage
        return ()

    def _why_missing(self, n_skipped: int) -> str:
        if not n_skipped:
            return ""
        underruns = self.report().underruns
        new, self._underruns = underruns - self._underruns, underruns
        damage, self._damage_without_id = self._damage_without_id, ""
        if new:
            return "underrun: no buffer was free"
        return f"{damage}, its leader too" if damage else "never came"

    def _frame(self, buffer: GiBuffer, frame_id: int) -> ArrivedFrame | LostFrame:
        code = BY_PFNC.get(buffer.get_image_pixel_format())
        shape = (buffer.get_image_height(), buffer.get_image_width())
        wanted = self._settings.frame_shape
        if code is None or code.name != self._settings.pixel_format or shape != wanted:
            name = code.name if code else "an unknown format"
            return LostFrame(frame_id, f"wrong-image: {shape[1]} x {shape[0]} of {name}")
        if any(buffer.get_image_padding()):
            return LostFrame(frame_id, f"wrong-image: padding {buffer.get_image_padding()}")
        try:
            dn = unpacked(received_bytes(buffer), code, *shape, self._options.byte_order)
        except ValueError as error:
            return LostFrame(frame_id, f"truncated: {error}")
        return ArrivedFrame(dn, frame_id, buffer.get_timestamp(), buffer.get_system_timestamp())
