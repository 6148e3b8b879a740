"""Departures from DN = L·VE·QE·t + DN0: taken out of a calibration, and out of lines."""
