"""A plan in words: every step, and an estimate. What `--dry-run` prints and `validate` answers."""

from service.plan.estimate import estimate
from service.plan.expand import expand
from service.plan.model import Plan

_SIZE_UNKNOWN = "size unknown until the camera says how many columns it has"


def describe(plan: Plan, *, columns: int | None = None, rows: int | None = None) -> str:
    """Return one line per step and a last one with time and size; nothing moves.

    Args:
        plan: What would be measured.
        columns: Of the camera, where the plan does not say.
        rows: Of an area camera, where the plan does not say.
    """
    steps = expand(plan)
    width = columns or plan.camera.columns
    ahead = estimate(plan, steps, columns=width or 1, rows=rows or plan.camera.rows)
    size = f"{ahead.n_bytes / 1e6:.1f} MB" if width else _SIZE_UNKNOWN
    total = (
        f"{len(steps)} blocks, {sum(step.lines for step in steps)} lines: at least"
        f" {in_words(ahead.total_s)}, of these {in_words(ahead.exposing_s)} exposing,"
        f" {in_words(ahead.waiting_s)} waiting for lamps,"
        f" {in_words(ahead.reading_s)} reading them back; {size}"
    )
    return "\n".join([*(step.line for step in steps), total])


def in_words(seconds: float) -> str:
    """Return a duration as a person says it.

    >>> in_words(42.4), in_words(75), in_words(7260)
    ('42 s', '1 min 15 s', '2 h 1 min')
    """
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"
