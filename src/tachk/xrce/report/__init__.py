"""What happened on the wire, as people and programs read it."""
