"""Logs of other systems as traces: JSON lines, texts as values, several recordings joined by time."""
