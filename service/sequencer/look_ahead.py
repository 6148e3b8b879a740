"""Will the next block saturate? Predicted from the blocks before it."""

from collections.abc import Sequence

from calib.recording.header import Block

BRIGHTEST_KEY = "brightest_column_dn"
"""Under this key a recorded block keeps the mean of its brightest column, or pixel of frames."""


def predicted_dn(block: Block, before: Sequence[Block], *, limit_dn: float) -> float | None:
    """Return the expected mean of the brightest column of the flat `block`; None if unknown.

    Linear in exposure and light from the latest unsaturated flat, preferably of the same level,
    on the latest dark as offset. Where only saturated flats came before, the dimmest of them is
    a lower bound, and good for a prediction only of what is brighter still.
    """
    flats = [b for b in before if b.kind == "flat" and brightest(b) is not None]
    darks = [b for b in before if b.kind == "dark" and brightest(b) is not None]
    offset_dn = (brightest(darks[-1]) or 0.0) if darks else 0.0
    useful = [b for b in flats if (brightest(b) or 0.0) < limit_dn]
    if not useful:
        return _from_saturated(block, flats, limit_dn)
    alike = [b for b in useful if b.level == block.level]
    reference = (alike or useful)[-1]
    ratio = _light(block, reference)
    if ratio is None:
        return None
    return offset_dn + ((brightest(reference) or 0.0) - offset_dn) * ratio


def brightest(block: Block) -> float | None:
    """Return the mean code of the brightest column, where the block was taken."""
    value = (block.model_extra or {}).get(BRIGHTEST_KEY)
    return None if value is None else float(value)


def _light(block: Block, reference: Block) -> float | None:
    """Return how many times the light of `reference` reaches the sensor in `block`."""
    if block.radiance is not None and reference.radiance:
        levels = block.radiance / reference.radiance
    elif reference.level > 0:
        levels = block.level / reference.level
    else:
        return None
    return levels * block.exposure_us / reference.exposure_us


def _from_saturated(block: Block, flats: Sequence[Block], limit_dn: float) -> float | None:
    at_least = [ratio for b in flats if (ratio := _light(block, b)) is not None and ratio >= 1]
    return limit_dn if at_least else None
