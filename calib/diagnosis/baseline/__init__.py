"""The plain model fitted to a recording."""
