"""A model takes part in a real conversation: its packets go out by UDP, and those that arrive are steps of it."""
