"""Coordinates for a template without any.

In order of reading: `template` (the whole), `sketch` (what is placed), `layers` and `coordinates` (where locations
stand), `arrangement` and `grid` (candidates), `routing` (edges), `comments`, `polish`; `geometry` is what all of them
use.
"""
