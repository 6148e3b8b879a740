"""The camera's spectral response and the radiance that lamps' spectra have in its band."""
