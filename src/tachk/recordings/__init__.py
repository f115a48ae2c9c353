"""Recordings of real systems: traces and their readers, monitors that check them, conformance to a model."""
