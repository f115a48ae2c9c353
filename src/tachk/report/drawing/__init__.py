"""Pictures of templates.

`placement` finds coordinates, `layout_completion` keeps those that are known, `svg` and `png` draw.
"""
