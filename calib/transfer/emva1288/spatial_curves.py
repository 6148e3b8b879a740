"""Profiles, spectrograms and histograms of the averaged images: where nonuniformities lie.

Source: EMVA Standard 1288, Release 4.0 Linear, sections 8.5 to 8.7.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.transfer.emva1288.block_figures import BlockFigures
from calib.transfer.emva1288.block_image import Image
from calib.transfer.emva1288.defects import Histogram, histogram_of
from calib.transfer.emva1288.highpass import LEAST, highpass

Numbers = NDArray[np.float64]


@dataclass(frozen=True)
class Profile:
    """An image along one axis: over all lines across it their mean, least and largest, and one.

    Attributes:
        mean, least, largest: At each place along the axis.
        middle: The line in the middle.
    """

    mean: Numbers
    least: Numbers
    largest: Numbers
    middle: Numbers


@dataclass(frozen=True)
class Spectrogram:
    """Power along one axis, averaged over the lines across it.

    Attributes:
        per_pixel: Frequencies, cycles per pixel, 0 … 0.5.
        power: White noise of variance v gives v at every frequency.
        white: What the temporal noise's residue gives.
    """

    per_pixel: Numbers
    power: Numbers
    white: float


@dataclass(frozen=True)
class ImageCurves:
    """One averaged image's curves; vertical ones are None of a line sensor.

    Attributes:
        block: Its block.
        n_frames: Averaged over so many.
        unit: Of every ordinate: DN in the dark, percent of the mean signal under light.
        horizontal, vertical: Profiles along rows and along columns.
        across, down: Spectrograms along rows and along columns, in `unit`².
        histogram: Of the pixels, under light behind the highpass.
    """

    block: str
    n_frames: int
    unit: str
    horizontal: Profile
    vertical: Profile | None
    across: Spectrogram
    down: Spectrogram | None
    histogram: Histogram


@dataclass(frozen=True)
class SpatialCurves:
    """The dark's and the 50 % flat's curves; the flat's dark is taken off."""

    dark: ImageCurves
    flat: ImageCurves


def curves_of(
    dark: Image, flat: Image, of_dark: BlockFigures, of_flat: BlockFigures
) -> SpatialCurves:
    """Return both images' curves, (n_rows, n_columns) each, DN."""
    light = flat - dark
    signal = float(light.mean())
    residue = of_dark.within_dn2 / of_dark.n_frames
    both = residue + of_flat.within_dn2 / of_flat.n_frames
    percent = 100.0 * light / signal
    filtered = highpass(percent) if can_filter(percent.shape) else percent
    white = both * (100.0 / signal) ** 2
    in_dark = histogram_of(dark, grain=1.0 / of_dark.n_frames)
    return SpatialCurves(
        _curves(dark, "DN", of_dark, residue, in_dark),
        _curves(percent, "%", of_flat, white, histogram_of(filtered)),
    )


def can_filter(shape: tuple[int, ...]) -> bool:
    """Tell whether an image is large enough for the highpass filter."""
    rows, columns = shape
    return columns >= LEAST and (rows == 1 or rows >= LEAST)


def _curves(
    image: Image, unit: str, figures: BlockFigures, white: float, histogram: Histogram
) -> ImageCurves:
    tall = image.shape[0] > 1
    return ImageCurves(
        block=figures.block.block,
        n_frames=figures.n_frames,
        unit=unit,
        horizontal=_profile(image),
        vertical=_profile(image.T) if tall else None,
        across=_spectrogram(image, white),
        down=_spectrogram(image.T, white) if tall else None,
        histogram=histogram,
    )


def _profile(image: Image) -> Profile:
    return Profile(
        image.mean(axis=0), image.min(axis=0), image.max(axis=0), image[len(image) // 2].copy()
    )


def _spectrogram(image: Image, white: float) -> Spectrogram:
    """|DFT|²/N of each line less the image's mean, averaged over the lines."""
    n = image.shape[1]
    power = np.mean(np.abs(np.fft.rfft(image - image.mean(), axis=1)) ** 2, axis=0) / n
    return Spectrogram(np.arange(len(power)) / n, power, white)
