"""The coefficient set: arrays, metadata, budget, and the file that its content names."""
