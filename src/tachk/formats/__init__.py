"""Formats of other tools, and of tachk itself. Each has a room and knows no other; `catalogue` lists them."""
