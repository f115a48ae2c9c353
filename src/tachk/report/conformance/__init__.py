"""What `tachk conform` tells: `words` (what events and moments are called), `text`, `json`."""
