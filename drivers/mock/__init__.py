"""Stand-ins for hardware: an in-process bench, and emulators on pseudo-terminals."""
