"""Models of links that lose messages and share a budget of losses."""
