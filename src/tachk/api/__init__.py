"""The library: models, recordings, and what scripts ask about them. ``import tachk`` is enough."""
