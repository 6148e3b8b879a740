"""From statistics to DN0, VE, QE and the radiance scale, each with its uncertainty."""
