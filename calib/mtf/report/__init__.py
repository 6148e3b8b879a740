"""The transfer function's report: one HTML file of figures, and the figures themselves."""
