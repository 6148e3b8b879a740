"""A camera without any transport: the forward model behind the camera's port, in this process."""

import time
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from threading import RLock

import numpy as np

from calib.forward.model import Model
from drivers.errors import DeviceError, DeviceLostError, DeviceTimeoutError
from drivers.frame_losses import LossLimit
from drivers.mock.camera_faults import CameraFaults
from drivers.mock.limits import CameraLimits
from drivers.mock.refusals import accepted
from drivers.mock.sensor import VirtualSensor
from drivers.mock.world import World
from drivers.ports import (
    CameraSettings,
    Cancelled,
    CapturedFrame,
    DeviceIdentity,
    LostFrame,
    never,
)

_SLICE_S = 0.05  # how long a cancelled wait may go on


class MockCamera:
    """Draw frames afresh from `model` under the light of `world`; the sensor's pixels are real.

    Paced, a frame comes every `frame_lines` line periods, as from a real camera; unpaced, as fast
    as it is drawn, while the camera's own clock runs on by the frame period all the same.
    """

    def __init__(
        self,
        model: Model,
        world: World,
        seed: int | None = None,
        *,
        paced: bool = True,
        frame_timeout_s: float = 2.0,
    ) -> None:
        self._sensor = VirtualSensor(model, world, np.random.default_rng(seed))
        header = model.camera
        self._limits = CameraLimits(header.columns, header.bit_depth, header.rows)
        self._identity = DeviceIdentity(
            vendor="darkflat",
            model=model.camera.model or "mock camera",
            serial=model.camera.serial or "MOCK",
            address="in-process",
        )
        self._paced = paced
        self._frame_timeout_s = frame_timeout_s
        self._lock = RLock()
        self._settings: CameraSettings | None = None
        self._started_s = time.monotonic()
        self._clock_s = 0.0
        self._frame_id = 0
        self.faults = CameraFaults()
        self._closed = False
        self._acquiring = False

    @property
    def identity(self) -> DeviceIdentity:
        """Vendor, model, serial number as the model file says."""
        return self._identity

    def configure(self, wanted: CameraSettings) -> CameraSettings:
        """Apply `wanted`; return it rounded to the camera's steps.

        Raises:
            SettingRefusedError: A value is out of range or off its step.
        """
        with self._lock:
            self._must_be_there()
            if self._acquiring:
                raise self._error("is acquiring; end the acquisition first", "camera-acquiring")
            self._settings = accepted(wanted, self._limits, self._name)
            return self._settings

    def frames(
        self, n_frames: int, cancelled: Cancelled = never
    ) -> Iterator[CapturedFrame | LostFrame]:
        """Yield frames until `n_frames` whole ones came; see `LinescanCamera.frames`."""
        with self._lock:
            self._must_be_there()
            if self._acquiring:
                raise self._error("is acquiring already", "camera-acquiring")
            settings = self._settings
            if settings is None:
                raise self._error("is not configured; configure it first", "camera-not-configured")
            self._acquiring = True
            self._clock_s = max(self._clock_s, self._now_s)
        try:
            limit = LossLimit(n_frames, self._name)
            whole = 0
            while whole < n_frames:
                if not self._wait_for_frame(settings, cancelled):
                    return
                frame = self._next_frame(settings)
                if isinstance(frame, LostFrame):
                    yield frame
                    limit.count_lost()
                else:
                    whole += 1
                    yield frame
        finally:
            self._acquiring = False

    def temperature_c(self) -> float | None:
        """The world's sensor temperature."""
        with self._lock:
            self._must_be_there()
            return self._sensor.world.state().sensor_temperature_c

    def features(self) -> Mapping[str, str]:
        """The settings, and who the camera says it is."""
        with self._lock:
            self._must_be_there()
            told = asdict(self._identity)
            if self._settings is not None:
                told |= asdict(self._settings)
            return {name: str(value) for name, value in told.items()}

    def draw_afresh(self) -> None:
        """Draw noise from now on that no seed repeats."""
        with self._lock:
            self._sensor.draw_afresh()

    def close(self) -> None:
        """Release the camera; every later call but this one fails."""
        self._closed = True

    @property
    def _name(self) -> str:
        return f"camera {self._identity.serial} (in-process)"

    @property
    def _now_s(self) -> float:
        return time.monotonic() - self._started_s if self._paced else self._clock_s

    def _wait_for_frame(self, settings: CameraSettings, cancelled: Cancelled) -> bool:
        """Wait until the next frame's lines are exposed; False where cancelled."""
        period_s = _frame_period_s(settings)
        due_s = self._clock_s + period_s
        give_up_s = time.monotonic() + period_s + self._frame_timeout_s
        while not cancelled():
            self._must_be_there()
            late_s = self._now_s - due_s
            if not self.faults.stalled and (not self._paced or late_s >= 0):
                return True
            if time.monotonic() > give_up_s:
                raise DeviceTimeoutError(
                    f"{self._name}: no frame came within {self._frame_timeout_s:g} s of its time",
                    device=self._name,
                    code="frame-timeout",
                )
            time.sleep(_SLICE_S if self.faults.stalled else min(-late_s, _SLICE_S))
        return False

    def _next_frame(self, settings: CameraSettings) -> CapturedFrame | LostFrame:
        with self._lock:
            period_s = _frame_period_s(settings)
            # A consumer that was away finds the camera where it is now.
            began_s = max(self._clock_s, self._now_s - period_s)
            self._clock_s = began_s + period_s
            self._frame_id += 1
            if self.faults.takes_next_frame():
                return LostFrame(self._frame_id, "missing-packets (told to lose it)")
            dn = self._sensor.expose(settings, began_s)
            return CapturedFrame(
                dn=dn,
                frame_id=self._frame_id,
                device_timestamp_ns=round(self._clock_s * 1e9),
                host_timestamp_ns=time.time_ns(),
                exposure_us=settings.exposure_us,
                gain_db=settings.gain_db,
                sensor_temperature_c=self._sensor.world.state().sensor_temperature_c,
            )

    def _must_be_there(self) -> None:
        if self._closed:
            raise self._error("is closed; open it again", "device-closed")
        if self.faults.vanished:
            raise DeviceLostError(
                f"{self._name}: does not answer any more; is it still plugged in?",
                device=self._name,
                code="control-lost",
            )

    def _error(self, what: str, code: str) -> DeviceError:
        return DeviceError(f"{self._name}: {what}", device=self._name, code=code)


def _frame_period_s(settings: CameraSettings) -> float:
    return settings.frame_lines * settings.line_period_us * 1e-6
