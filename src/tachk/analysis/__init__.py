"""Analyses of the text of a network without a search: intervals, constant expressions, conditions, components.

`interpreter` evaluates expressions over a domain: the one in `intervals`, or the terms of z3 in
`tachk.engine.smt.machine`.
"""
