"""Several recordings of one bench as one: their blocks one after the other, on one clock.

Common to all, since it is one camera at one setting: each pixel's offset and slope, system gain,
read noise, and the parameters of effects. The lamps are taken to give the radiance that their level
is certified for, after they were lit anew as before it, and drifts go on meanwhile as if nobody had
looked. Where more than an hour lies between two recordings, that is no longer so for what
temperature, dust and lamps change, and the later one has offsets and slopes of its own.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from calib.arrays import Columns
from calib.errors import InputError
from calib.recording.header import Block, CameraHeader, RecordingHeader

HOURS_APART_S = 3600.0
"""Recordings with more time between them have offsets and slopes of their own."""
_ALIKE = (
    "columns", "rows", "first_column", "first_row", "bit_depth", "gain_db", "black_level_dn",
    "taps", "tap_layout", "readout", "line_period_us",
)  # fmt: skip


@dataclass(frozen=True)
class Joint:
    """Recordings as one.

    Attributes:
        header: Of all blocks; "2:003" is block 003 of the second recording.
        order: In which the recordings were made, as indices of those that were given.
        sessions: Of each block; empty where all are of one.
        note: What is taken for common, one sentence; empty of a single recording.
    """

    header: RecordingHeader
    order: tuple[int, ...]
    sessions: tuple[int, ...]
    note: str


def joint(headers: Sequence[RecordingHeader]) -> Joint:
    """Return the recordings as one; InputError where they cannot be of one bench."""
    if len(headers) == 1:
        return Joint(headers[0], (0,), (), "")
    for number, header in enumerate(headers[1:], start=2):
        _check_alike(headers[0].camera, header.camera, number)
    order = tuple(sorted(range(len(headers)), key=lambda k: _began_s(headers[k].camera)))
    blocks: list[Block] = []
    sessions: list[int] = []
    session, ended_s = 0, 0.0
    origin_s = _began_s(headers[order[0]].camera)
    for position, k in enumerate(order):
        shift_s = _began_s(headers[k].camera) - origin_s
        if position and headers[k].camera.started_at is None:
            shift_s = ended_s
        placed = _placed(headers[k], k + 1, shift_s)
        if position:
            _check_later(placed, ended_s, k + 1)
            session += _starts_s(placed) - ended_s > HOURS_APART_S
        blocks += placed
        sessions += [session] * len(placed)
        ended_s = _ends_s(placed, headers[k].camera)
    header = headers[order[0]].model_copy(update={"blocks": tuple(blocks)})
    parted = tuple(sessions) if session else ()
    return Joint(header, order, parted, _note(session))


def joint_images(images: Sequence[Mapping[str, Columns]]) -> Mapping[str, Columns]:
    """Return the images of all recordings by the names that their scenes have in a joint header."""
    if len(images) == 1:
        return images[0]
    return {f"{k}:{name}": i for k, each in enumerate(images, start=1) for name, i in each.items()}


def _check_alike(first: CameraHeader, other: CameraHeader, number: int) -> None:
    differing = [name for name in _ALIKE if getattr(first, name) != getattr(other, name)]
    if first.serial and other.serial and first.serial != other.serial:
        differing.insert(0, "serial")
    if differing:
        name = differing[0]
        raise InputError(
            f"recording {number} is not of the first one's camera and settings: its {name} is "
            f"{getattr(other, name)}, not {getattr(first, name)}; diagnose it by itself",
            code="recordings-differ",
        )


def _check_later(placed: Sequence[Block], ended_s: float, number: int) -> None:
    if _starts_s(placed) < ended_s - 1e-3:
        raise InputError(
            f"recording {number} begins {ended_s - _starts_s(placed):.3g} s before the one before "
            "it ends, and one camera cannot make both at once; correct camera.started_at, or give "
            "each recording once",
            code="recordings-overlap",
        )


def _began_s(camera: CameraHeader) -> float:
    return 0.0 if camera.started_at is None else camera.started_at.timestamp()


def _placed(header: RecordingHeader, number: int, shift_s: float) -> list[Block]:
    """Return the blocks on the common clock, all with a start."""
    free_s, placed = 0.0, []
    for block in header.blocks:
        start_s = free_s if block.started_s is None else block.started_s
        changed: dict[str, object] = {
            "block": f"{number}:{block.block}",
            "started_s": start_s + shift_s,
            # A target that was taken away in between does not stand where it stood.
            "scene": block.scene and f"{number}:{block.scene}",
        }
        placed.append(block.model_copy(update=changed))
        free_s = start_s + (block.lines or 0) * (header.camera.line_period_us or 0.0) * 1e-6
    return placed


def _starts_s(placed: Sequence[Block]) -> float:
    return min((block.started_s or 0.0 for block in placed), default=0.0)


def _ends_s(placed: Sequence[Block], camera: CameraHeader) -> float:
    period_s = (camera.line_period_us or 0.0) * 1e-6
    return max(((b.started_s or 0.0) + (b.lines or 0) * period_s for b in placed), default=0.0)


def _note(apart: int) -> str:
    if apart:
        return (
            "Hours lie between the recordings: gain, noise and effects are taken for common, "
            "offsets and slopes of each session for its own."
        )
    return (
        "Offsets, slopes, gain, noise and effects are taken for common to the recordings, and the "
        "lamps' radiance for what it was before they were lit anew."
    )
