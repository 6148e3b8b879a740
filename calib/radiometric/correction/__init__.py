"""From raw DN to radiance: terms by column, checks, flags, streams."""
