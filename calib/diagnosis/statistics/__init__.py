"""One pass over a recording that keeps all that is needed to find where a mismatch lives."""
