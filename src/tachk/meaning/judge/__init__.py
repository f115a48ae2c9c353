"""The independent check of what engines claim; it knows the meaning of networks and no engine."""
