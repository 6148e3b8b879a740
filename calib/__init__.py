"""Physics and mathematics: no device, no web. Reads and writes its own files."""
