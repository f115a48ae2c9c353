"""The independent check of runs and certificates; it knows the meaning of networks and no engine."""
