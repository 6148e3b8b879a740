"""The data sheet to look at: one page that needs nothing but itself."""
