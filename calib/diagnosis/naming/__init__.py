"""Which effects there are: signatures, search, refit, held-out tests, and how sure a name is."""
