"""Options of the commands about simulated runs."""
