"""Which effects there are: search, refit, held-out tests, and how sure a name is."""
