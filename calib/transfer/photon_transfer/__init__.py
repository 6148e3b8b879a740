"""Photon transfer: how variance, and covariance of neighbours, grow with the signal."""
