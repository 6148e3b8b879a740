"""The pixel's transfer function and its PSF, from a self-imaging grating or from an edge."""
