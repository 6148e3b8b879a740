"""A model that somebody believes in, beside what a recording says."""
