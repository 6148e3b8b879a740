"""What is worked out of recordings, for commands and for jobs alike; files go where they say."""
