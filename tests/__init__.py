"""Tests; `tests/contracts` holds what every device promises."""
