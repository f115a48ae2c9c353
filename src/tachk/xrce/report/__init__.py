"""Reports of the events on the wire, for people and programs."""
