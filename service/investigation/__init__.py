"""Sweep, diagnose, run the deciding sweep, diagnose both: until a recording's physics is named."""
