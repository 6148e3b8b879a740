"""Diagnosis of a recording of which only sums survive: one mean and one variance of each block."""
