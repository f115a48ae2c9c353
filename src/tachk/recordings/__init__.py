"""Recordings of real systems: traces and their readers, monitors that judge them, conformance to a model."""
