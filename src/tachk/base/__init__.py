"""What every other package may use: diagnostics, places in texts, units of time, limits, data files."""
