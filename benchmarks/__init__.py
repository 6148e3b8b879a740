"""How fast the hot loops are, beside NumPy, a peer and the machine's limit, in one run."""
