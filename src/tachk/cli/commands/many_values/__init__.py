"""Commands that vary constants of a model."""
