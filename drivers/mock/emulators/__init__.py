"""Controllers on pseudo-terminals: real bytes, the protocol's own timing, and faults on command."""
