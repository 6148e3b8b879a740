"""When the lines of a free-running linescan camera are exposed: on one grid, without overlap."""


class LineClock:
    """Hand out the start of each frame; two frames share no line, and time never runs back."""

    def __init__(self) -> None:
        self._free_from_s = 0.0

    def next_frame(self, now_s: float, n_lines: int, line_period_us: float) -> float:
        """Return when a frame that is taken at `now_s` starts: with the next line after the last.

        Frames that follow one another without a pause thus form one uninterrupted row of lines,
        however unsteadily they are fetched.
        """
        period_s = line_period_us * 1e-6
        late_s = now_s - self._free_from_s
        if late_s > n_lines * period_s / 2:  # a pause: lines went by that nobody took
            self._free_from_s += round(late_s / period_s) * period_s
        started_s = self._free_from_s
        self._free_from_s += n_lines * period_s
        return started_s
