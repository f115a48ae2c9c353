"""Pictures of templates and sequence charts: `svg` and `png` draw."""
