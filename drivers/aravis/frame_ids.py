"""Which frames never came: gaps in the camera's own count."""

_WRAP = 65535  # GigE Vision 1.x counts 1 .. 65535 and then 1 again; 0 is no frame


class FrameIds:
    """Follow the ids of the frames that arrive; ids above 65535 are 64-bit ones and never wrap."""

    def __init__(self) -> None:
        self._last: int | None = None
        self._missing: set[int] = set()

    def missing_before(self, frame_id: int) -> tuple[int, ...]:
        """Return the ids that were skipped since the frame before, oldest first.

        A frame that comes late, after it was named missing, skips nothing; see `was_missed`.
        """
        last, self._last = self._last, frame_id
        if last is None:
            return ()
        step = self._step(last, frame_id)
        if step <= 0:
            self._last = last
            return ()
        counted = range(last + 1, last + step)
        wide = self._wide(last, frame_id)
        skipped = tuple(k - _WRAP if k > _WRAP and not wide else k for k in counted)
        self._missing = set(skipped)
        return skipped

    @property
    def started(self) -> bool:
        """Whether a frame has come."""
        return self._last is not None

    def may_be_next(self, frame_id: int) -> bool:
        """Whether `frame_id` can be that of a frame that comes now.

        A damaged frame whose leader is lost has no id: Aravis leaves 0 in its buffer, or the id
        of the frame that was in it before.
        """
        return frame_id > 0 and (self._last is None or self._step(self._last, frame_id) > 0)

    def was_missed(self, frame_id: int) -> bool:
        """Whether `frame_id` was named missing in the latest gap, and now comes after all."""
        return frame_id in self._missing

    @staticmethod
    def _wide(*ids: int) -> bool:
        return max(ids) > _WRAP

    def _step(self, last: int, new: int) -> int:
        if self._wide(last, new):
            return new - last
        step = (new - last) % _WRAP
        return step if step <= _WRAP // 2 else step - _WRAP
