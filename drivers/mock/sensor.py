"""The sensor inside every simulated camera: the forward model, looking at the simulated world."""

from dataclasses import replace

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines, RawLines
from calib.forward.conditions import Conditions
from calib.forward.effects.illumination import Illumination
from calib.forward.left import Left
from calib.forward.model import Model
from calib.forward.scene import bar
from calib.recording.frame_codes import sample_shape
from drivers.mock.world import World
from drivers.pixel_formats import FORMATS
from drivers.ports import CameraSettings, PixelFormat


def aligned(dn: RawLines, adc_bits: int, pixel_format: PixelFormat) -> RawLines:
    """Return the ADC's codes as `pixel_format` carries them: the most significant bits agree.

    A format with fewer bits than the ADC drops the least significant ones; one with more has
    zeros there, so that full scale stays full scale.

    Args:
        dn: Codes, 0 .. 2**adc_bits - 1.
        adc_bits: Bits of the ADC.
        pixel_format: The format to carry them in.

    Returns:
        Of the same shape, uint8 for Mono8, else uint16; a new array unless nothing changes.
    """
    bits = FORMATS[pixel_format].bits
    if bits < adc_bits:
        dn = np.right_shift(dn, adc_bits - bits)
    elif bits > adc_bits:
        dn = np.left_shift(dn.astype(np.uint16), bits - adc_bits)
    return dn.astype(np.uint8, copy=False) if bits == 8 else dn.astype(np.uint16, copy=False)


class VirtualSensor:
    """Draw frames of `model` under the light of `world`, afresh each time.

    What one exposure leaves in the pixels, the next one finds.
    """

    def __init__(self, model: Model, world: World, rng: Generator) -> None:
        self.model = model
        self.world = world
        self._rng = rng
        self._left: Left | None = None

    def expose(self, settings: CameraSettings, started_s: float) -> RawLines:
        """Expose one frame whose first line starts `started_s` after the camera's clock did.

        Returns:
            Codes of the pixel format's bit depth, of the settings' `frame_shape`.
        """
        at = replace(self.conditions(settings, started_s), before=self._left)
        at, scene = self._seen(at)
        drawn = self.model.draw(at, self._rng, scene)
        self._left, dn = drawn.left, drawn.dn
        first, row = settings.first_column, settings.first_row
        region = dn[..., first : first + settings.n_columns]
        if settings.n_rows is not None:
            region = region[0, row : row + settings.n_rows]
        return aligned(region, self.model.camera.bit_depth, settings.pixel_format)

    def _seen(self, at: Conditions) -> tuple[Conditions, Lines | None]:
        """Return conditions and scene; a target lets the lamps' light through its slit alone."""
        illumination = self.model.effect("illumination")
        if not self.world.state().barred or not isinstance(illumination, Illumination):
            return at, None
        columns = self.model.camera.columns
        image = np.broadcast_to(
            illumination.total(at.lamps) * bar(columns), sample_shape(self.model.camera)
        )
        return replace(at, lamps=()), np.asarray(image)

    def draw_afresh(self) -> None:
        """Draw noise from now on that no seed repeats."""
        self._rng = np.random.default_rng()

    def conditions(self, settings: CameraSettings, started_s: float) -> Conditions:
        """Return the conditions of that frame: the camera's settings, and the world as it is."""
        world = self.world.state()
        return Conditions.steady(
            settings.frame_lines,
            exposure_us=settings.exposure_us,
            line_period_us=settings.line_period_us,
            started_s=started_s,
            lamps=world.emissions(),
            capped=world.capped,
            sensor_temperature_c=world.sensor_temperature_c,
            gain_db=settings.gain_db,
            black_level_dn=settings.black_level_dn,
        )
