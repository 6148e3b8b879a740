"""The bench's one owner: a process of its own that everything else talks to."""
