"""Other ways to the same answers, slow and simple: what the engine is tested against."""
