"""Captures of packets while they are made."""
