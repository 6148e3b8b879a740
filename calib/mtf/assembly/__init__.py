"""Where the images lie on the pattern, and the oversampled grid that they fill."""
