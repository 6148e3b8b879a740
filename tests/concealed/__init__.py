"""The proof: recordings whose secret the diagnosis does not know, and how well it finds it.

`generator` draws recordings from mechanisms of its own and imports nothing of the program;
`scoring` runs a diagnosis over them and measures it.
"""
