import numpy as np

from calib.kernels.noisy_signal import noisy_signal


def test_noise_gain_and_offset_are_those_of_plain_numpy() -> None:
    rng = np.random.default_rng()
    charge, shot, read = rng.normal(50.0, 60.0, (3, 5, 4, 6))
    read_e, gain, offset = rng.uniform(0.5, 2.0, (3, 4, 6))
    plain = (charge + np.sqrt(np.maximum(charge, 0.0)) * shot + read_e * read) * gain + offset
    # Sums of three terms round three times.
    np.testing.assert_allclose(
        noisy_signal(charge, shot, read, read_e, gain, offset), plain, rtol=0, atol=1e-10
    )
