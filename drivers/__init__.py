"""Devices behind small protocols: blocking, one owner, one lock each."""
