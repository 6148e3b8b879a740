"""The diagnosis in words that an operator understands, every number of them from the recording."""
