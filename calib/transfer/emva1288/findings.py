"""What a reader of the data sheet has to know of the recording, one sentence each."""

from collections.abc import Iterator

import numpy as np

from calib.transfer.emva1288.choices import HALF, saturation_shares
from calib.transfer.emva1288.formulas import Formulas

LEAST_FRAMES = 16
LEAST_EXPOSURES = 6
MOST_AT_ZERO = 0.005
Found = dict[str, tuple[float, float]]


def findings(
    formulas: Formulas, misfits: tuple[float, float], found: Found, filtered: bool
) -> Iterator[str]:
    """Yield them."""
    yield from _saturation(formulas)
    yield from _lines(misfits)
    yield from _linearity(formulas, found)
    yield from _darks(formulas)
    if formulas.spatial is not None:
        yield from _spatial(formulas, filtered)


def _saturation(formulas: Formulas) -> Iterator[str]:
    point = formulas.point
    if point.reason:
        yield f"{point.reason}; 0 … 70 % are taken of the highest code instead"
    elif not point.by_share:
        yield (
            "saturation is taken at the largest temporal variance, as release 3.1 has it, since "
            "no share of samples at the highest code is known or large enough"
        )


def _lines(misfits: tuple[float, float]) -> Iterator[str]:
    for what, curve, added in zip(
        ("system gain", "responsivity"), ("photon transfer", "response"), misfits, strict=True
    ):
        if added > 0:
            yield (
                f"the {curve} curve is no straight line within its noise: the {what}'s "
                f"uncertainty is widened by {100 * added:.2g} % for it"
            )


def _linearity(formulas: Formulas, found: Found) -> Iterator[str]:
    if "linearity_error_percent" not in found:
        return
    noise = [found[f"deviation_percent {k}"][1] for k in formulas.fits.linearity]
    floor = float(np.sqrt(2.0 / np.pi) * np.mean(noise))
    if found["linearity_error_percent"][0] < 2.0 * floor:
        yield (
            f"the linearity error is hardly above {floor:.2g} %, which noise alone makes of a "
            "straight line: it is an upper limit, and its uncertainty says too little"
        )


def _darks(formulas: Formulas) -> Iterator[str]:
    series = formulas.series
    zero = max(d.share_at_zero for d in series.darks)
    if zero > MOST_AT_ZERO:
        yield (
            f"up to {100 * zero:.2g} % of a dark's samples are at code 0: raise the black level, "
            "or dark noise and threshold come out too small"
        )
    group = series.temperatures[series.own_temperature]
    exposures = {series.darks[k].block.exposure_us for k in group}
    if 1 < len(exposures) < LEAST_EXPOSURES:
        yield (
            f"the dark current is from {len(exposures)} exposures; the standard asks for "
            f"{LEAST_EXPOSURES}"
        )


def _spatial(formulas: Formulas, filtered: bool) -> Iterator[str]:
    series = formulas.series
    if formulas.spatial is None:
        return
    index = formulas.spatial.flat_index
    share = float(saturation_shares(series, formulas.point)[index])
    if not HALF[0] <= share <= HALF[1]:
        yield (
            f"PRNU is from block {series.flats[index].block.block} at {100 * share:.0f} % of "
            "saturation; the standard takes 50 %"
        )
    pair = (series.flats[index], series.darks[series.dark_of[index]])
    few = [f.block.block for f in pair if f.n_frames < LEAST_FRAMES]
    if few:
        yield (
            f"the averaged image(s) of block(s) {', '.join(few)} are from fewer than "
            f"{LEAST_FRAMES} frames, as many as the standard wants for nonuniformities"
        )
    if not filtered:
        yield "the image is too small for the highpass filter: nonuniformities are not filtered"
