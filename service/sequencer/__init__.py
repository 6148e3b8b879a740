"""Runs a plan on a bench: step by step, resumable, and dark at every end."""
