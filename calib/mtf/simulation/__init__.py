"""What a detector whose pixel response is known would record of a grating."""
