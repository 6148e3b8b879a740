"""A pytest plugin: `darkflat_bench` and the option `--bench` that names a real one.

Every pytest run of an environment that has darkflat loads this file: it imports nothing heavy.
"""
