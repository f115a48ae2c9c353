"""The options of commands about recorded packets."""
