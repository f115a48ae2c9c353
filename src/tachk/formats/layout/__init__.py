"""Where the locations and edges of templates are drawn, for those that have no coordinates yet."""
