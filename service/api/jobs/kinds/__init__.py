"""The kinds of long work; what they need they import when they begin, in their own process."""
