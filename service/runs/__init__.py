"""Runs as the service keeps them: queued, given the bench, followed, and put on record."""
