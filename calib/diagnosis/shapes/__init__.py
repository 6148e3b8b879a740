"""The shapes in which effects are looked for: of the catalogue, and told by the recording."""
