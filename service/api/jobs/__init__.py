"""Long work: a queue, and a process of its own for each job."""
