"""The page: what a browser shows of the bench. It asks and acts through what the API does."""
