"""What a recording holds that the plain model does not: where, what it is called, how much."""
