"""AgCam's calibration: dark offset, vignette, responsivity, radiance and its uncertainty."""
