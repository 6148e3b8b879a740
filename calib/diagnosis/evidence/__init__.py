"""A recording against its baseline, in the space where noise has unit size."""
