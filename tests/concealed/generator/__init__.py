"""Recordings from mechanisms: counts that are drawn, moved, split and lost, then volts and codes.

Plain NumPy, and no line in common with the program whose diagnosis is to be judged: import-linter
refuses one. Arrays are (n_samples, n_rows, n_columns); a line sensor has one row. A sample is a
line, or a frame of an area sensor.
"""
