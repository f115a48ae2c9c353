"""Exploration of the states of a network: `options` and `outcome` are what goes in and what comes out.

`zone` is the engine in use, in C++. `reference` (zones, in plain Python) and `digitised` (sampled clock values) are the
oracles that it is compared with. `concretise` makes a path into a run with exact delays, by solving a `schedule`.
"""
