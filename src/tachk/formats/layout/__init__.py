"""The layout of templates: coordinates for the locations and edges that have none yet."""
