"""`tachk requirements`."""
