"""What captures show of clients, streams and samples over time."""
