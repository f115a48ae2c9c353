"""Sequence charts of captures and of runs: what `tachk.drawing.sequence` draws."""
