"""Coordinates for a template without any, and for what was added to one that has some.

In order of reading: `template` (the whole, with comments), `sketch` (the boxes to place), `layers` and `coordinates`
(the places of locations), `arrangement` (candidates), `routing` (edges), `polish`; all of them use `geometry`.
`additions` keeps the coordinates that are known and finds free places (`room`) for the rest (`new_routes`).
"""
