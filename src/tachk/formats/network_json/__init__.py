"""Elaborated networks as JSON, written and read back."""
