"""Models of links that lose messages and share a counter of losses."""
