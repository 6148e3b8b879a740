"""System gain, bias, photo-electrons and read noise from one scene at two exposures.

Source: Yielding, Cain and Seal (2018), Statistical photocalibration of photodetectors for
radiometry without calibrated light sources, Opt. Eng. 57(1), 014107. Where this differs, and why,
is in docs/photon-transfer/two-exposures.md.
"""
