"""Photon transfer: from recordings alone to system gain, noise and electrons."""
