"""Exploration of the states of a network: `options` go in, an `outcome` comes out.

`compiler` makes the program that the core runs, `symmetry` finds its interchangeable processes, `zone` and `liveness`
search, `smt` is the second engine, `exact` makes a path into a run with exact delays.
"""
