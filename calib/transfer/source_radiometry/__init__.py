"""Radiometry of a source: the photons that a data sheet promises, and those that were counted."""
