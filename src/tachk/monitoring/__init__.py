"""Judging recorded traces: what `tachk.monitor`, `tachk.Monitor` and `tachk.plot` do."""
