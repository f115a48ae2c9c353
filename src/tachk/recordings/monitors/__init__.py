"""Judging recorded traces: what `tachk.monitor` and `tachk.Monitor` do."""
