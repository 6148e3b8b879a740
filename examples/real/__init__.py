"""Real recordings: how they become recording folders, what is measured of them, figures."""
