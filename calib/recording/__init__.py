"""The recording: its file, its commit record, salvage, import and export, statistics."""
