"""The plan that the page begins with: short, and right for the simulated bench."""

from typing import Final

EXAMPLE: Final = """\
name = "short sweep"
lines = 64

[sweep]
type = "exposure"
exposures_us = [50, 100, 200]
level = 2

[camera]
line_period_us = 1400
"""
