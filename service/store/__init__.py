"""The store: coefficient sets and their lives, recordings, jobs. SQLite by default."""
