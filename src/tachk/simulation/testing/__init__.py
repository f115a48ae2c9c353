"""Tests of a running system by its model: what may be sent to it, and whether it answers as the model allows."""
