"""Sequencer, store, API and command line: where the parts are joined."""
