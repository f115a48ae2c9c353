"""Estimates of probabilities and means from runs, with the stated confidence.

In order of reading: `sampling` (runs that are asked something), `stopping` (how many runs, and exact intervals for
a number of runs that depends on them), `deciding` (tests between two hypotheses), `means` (intervals for expectations),
`estimate` (answers to queries).
"""
