"""The diagnosis as one page that a person reads."""
