"""Pictures of templates.

`placement` finds coordinates, `completion` keeps those that are known, `svg` and `png` draw.
"""
