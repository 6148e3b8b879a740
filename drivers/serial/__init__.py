"""Controllers on a serial line: one link, one file per controller."""
