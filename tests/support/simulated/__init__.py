"""Simulated runs as the judge replays them."""
