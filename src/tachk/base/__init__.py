"""The base of every other package: diagnostics, places in texts, units of time, limits, data files."""
