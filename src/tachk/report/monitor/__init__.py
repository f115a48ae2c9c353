"""Reports of monitors, in every form."""
