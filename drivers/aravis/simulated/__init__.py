"""A simulated GigE Vision linescan camera, in a process of its own: `python -m` this package.

Aravis' `GvFakeCamera` speaks the protocol; the forward model draws the pixels.
"""
