"""Certificates on the command line: `writing` beside the answers of `tachk verify`, `checking` for `tachk certify`."""
