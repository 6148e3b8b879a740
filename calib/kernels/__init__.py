"""The few compiled loops; everything else is NumPy and SciPy."""
