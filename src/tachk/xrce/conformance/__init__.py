"""Captures of DDS-XRCE as recordings that are held against a model."""
