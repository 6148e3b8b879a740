"""The emulated lamps follow their current as the published powers say."""

import pytest

from drivers.mock.filament import relative_current, relative_emission, relative_voltage


def test_example_of_the_field_guide() -> None:
    # Field Guide to Illumination (SPIE FG11): 5 % more current, 1040 lm -> 1428 lm, 10.8 -> 11.8 V.
    assert 1040 * relative_emission(1.05) == pytest.approx(1428, abs=0.5)
    assert 10.8 * relative_voltage(1.05) == pytest.approx(11.8, abs=0.1)


@pytest.mark.parametrize("part", [0.0, 0.3, 1.0, 1.05])
def test_current_at_a_voltage_inverts_voltage_at_a_current(part: float) -> None:
    assert relative_current(relative_voltage(part)) == pytest.approx(part)
