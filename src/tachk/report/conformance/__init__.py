"""What `tachk conform` tells: `text`, `json`."""
