"""What `tachk monitor` and its relatives tell while they read."""
