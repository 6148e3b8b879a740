"""The transfer function from all pixels and positions at once, and how sure it is."""
