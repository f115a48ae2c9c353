"""Coordinates for a template without any.

In order of reading: `template` (the whole, with comments), `sketch` (the boxes to place), `layers` and `coordinates`
(the places of locations), `arrangement` (candidates), `routing` (edges), `polish`; all of them use `geometry`.
"""
