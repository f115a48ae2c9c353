"""Commands about recorded packets."""
