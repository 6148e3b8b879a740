"""Times other projects' code on the same work; run by their own interpreter.

    .venv-peers/bin/python benchmarks/peers.py JOB N_LINES N_COLUMNS

For each line on standard input the job is done once, and its seconds are printed, so that it takes
turns with the contestants of the process that asks.

It stands alone, since their environment (numpy < 2) has nothing of ours.
"""

# ruff: noqa: PLC0415 - each job imports its peer, and no other

import sys
import time
import warnings

import numpy as np

N_LINES, N_COLUMNS = (int(text) for text in sys.argv[2:4])
MEAN_E, READ_NOISE_E, GAIN_DN_PER_E = 8000.0, 10.0, 0.2


def simulate_with_pyxel():
    from pyxel.detectors import CCD, CCDGeometry, Characteristics, Environment
    from pyxel.models.charge_collection import simple_collection, simple_full_well
    from pyxel.models.charge_generation import simple_conversion
    from pyxel.models.charge_measurement import output_node_noise, simple_measurement
    from pyxel.models.photon_collection import shot_noise
    from pyxel.models.readout_electronics import simple_adc, simple_amplifier

    volt_per_e = 1e-6
    detector = CCD(
        geometry=CCDGeometry(
            row=N_LINES,
            col=N_COLUMNS,
            pixel_vert_size=10,
            pixel_horz_size=10,
            total_thickness=10,
        ),
        environment=Environment(temperature=300),
        characteristics=Characteristics(
            quantum_efficiency=1.0,
            charge_to_volt_conversion=volt_per_e,
            pre_amplification=1,
            full_well_capacity=40_000,
            adc_bit_resolution=12,
            adc_voltage_range=(0.0, 4096 / GAIN_DN_PER_E * volt_per_e),
        ),
    )
    photons = np.full((N_LINES, N_COLUMNS), MEAN_E)

    def once():
        detector.empty()
        detector.photon.array = photons.copy()
        shot_noise(detector)
        simple_conversion(detector)
        simple_collection(detector)
        simple_full_well(detector)
        simple_measurement(detector)
        output_node_noise(detector, std_deviation=READ_NOISE_E * volt_per_e)
        simple_amplifier(detector)
        simple_adc(detector)

    return once


def simulate_with_emva1288():
    from emva1288.camera.camera import Camera

    camera = Camera(
        bit_depth=12,
        width=N_COLUMNS,
        height=N_LINES,
        K=GAIN_DN_PER_E,
        sigma2_dark_0=READ_NOISE_E**2,
        u_esat=40_000.0,
        seed=1,
    )
    radiance = camera.get_radiance_for(mean=MEAN_E * GAIN_DN_PER_E)
    return lambda: camera.grab(radiance)


def correct_with_ccdproc():
    import astropy.units as u
    import ccdproc
    from astropy.nddata import CCDData

    rng = np.random.default_rng(1)
    frame = CCDData(rng.integers(300, 4000, (N_LINES, N_COLUMNS)).astype(np.uint16), unit="adu")
    ones = np.ones((N_LINES, N_COLUMNS), np.float32)
    bias = CCDData(100 * ones, unit="adu")
    dark = CCDData(2 * ones, unit="adu", header={"exposure": 1.0})
    flat = CCDData(ones * rng.normal(1, 0.03, N_COLUMNS).astype(np.float32), unit="adu")

    def once():
        reduced = ccdproc.subtract_bias(frame, bias)
        reduced = ccdproc.subtract_dark(
            reduced, dark, dark_exposure=1 * u.s, data_exposure=1 * u.s, scale=False
        )
        ccdproc.flat_correct(reduced, flat)

    return once


def sums_with_welford():
    """Welford's running mean and variance per column, as astronomers write it with NumPy."""
    frame = np.random.default_rng(1).integers(0, 4096, (N_LINES, N_COLUMNS)).astype(np.uint16)

    def once():
        mean = np.zeros(N_COLUMNS)
        squares = np.zeros(N_COLUMNS)
        for n, line in enumerate(frame, start=1):
            delta = line - mean
            mean += delta / n
            squares += delta * (line - mean)

    return once


JOBS = {
    "simulate-pyxel": simulate_with_pyxel,
    "simulate-emva1288": simulate_with_emva1288,
    "correct-ccdproc": correct_with_ccdproc,
    "sums-welford": sums_with_welford,
}


def main():
    warnings.simplefilter("ignore")
    once = JOBS[sys.argv[1]]()
    for _ in sys.stdin:
        start = time.perf_counter()
        once()
        print(time.perf_counter() - start, flush=True)


if __name__ == "__main__":
    main()
