"""Reports of `tachk conform`: `text`, `json`."""
