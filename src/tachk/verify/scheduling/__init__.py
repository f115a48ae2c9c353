"""In which order searches run, how many at a time, and how they share the time there is."""
