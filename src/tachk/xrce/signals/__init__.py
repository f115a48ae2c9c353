"""Signals of clients, streams and samples over time in captures."""
