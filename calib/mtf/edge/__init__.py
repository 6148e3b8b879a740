"""The transfer function across an edge: for benches without a grating, and for line sensors."""
