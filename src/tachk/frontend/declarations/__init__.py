"""Variables, functions, channels and parameters."""
