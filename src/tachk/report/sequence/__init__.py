"""Sequence charts of captures and of runs: what `tachk.report.drawing.sequence` draws."""
