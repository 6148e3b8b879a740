"""The calibration's report: one HTML file of figures that a person can judge a bench by."""
