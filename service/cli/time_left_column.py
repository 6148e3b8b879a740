"""The bar's column that says how long it still takes."""

import time

from rich.progress import Task, TimeRemainingColumn
from rich.text import Text


class TimeLeftColumn(TimeRemainingColumn):
    """Counts down to the task's field `until_s`, monotonic; rich's own guess for "by share"."""

    max_refresh = 0.0  # the clock is read each time

    def render(self, task: Task) -> Text:
        """Return the time left; dashes where nobody knows yet."""
        until_s = task.fields["until_s"]
        if until_s == "by share":
            return super().render(task)
        if until_s is None:
            return Text("-:--:--", style="progress.remaining")
        minutes, seconds = divmod(round(max(0.0, until_s - time.monotonic())), 60)
        hours, minutes = divmod(minutes, 60)
        return Text(f"{hours:d}:{minutes:02d}:{seconds:02d}", style="progress.remaining")
