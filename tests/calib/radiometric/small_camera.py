"""A small linescan camera on the paper's bench, plain: what its tests add departures to."""

from calib.forward.model import Model


def small_camera(columns: int, axis_column: float) -> Model:
    """Twelve bits, six lamps of 10 W m-2 sr-1, 0.05 DN/e-, 20 electrons of read noise, 40 DN."""
    return Model.loads(
        f"""
        [camera]
        serial = "B0001"
        columns = {columns}
        bit_depth = 12
        line_period_us = 1400.0
        band = "NIR"
        [source]
        kind = "sphere"
        lamps = 6
        radiance_unit = "W m-2 sr-1"
        [effects.illumination]
        radiance = [10.0, 10.0, 10.0, 10.0, 10.0, 10.0]
        [effects.vignette]
        axis_column = {axis_column}
        coefficients = [-0.3, 0.0, -0.1]
        [effects.responsivity]
        electrons_per_radiance_us = 9.0
        prnu_std = 0.02
        [effects.shot_noise]
        [effects.read_noise]
        std_e = 20.0
        [effects.system_gain]
        dn_per_e = 0.05
        [effects.offset]
        mean_dn = 40.0
        [effects.adc]
        bit_depth = 12
        """
    )
