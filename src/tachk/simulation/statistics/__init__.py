"""Estimates of probabilities and means from runs, with the stated confidence.

In order of reading: `sampling` (samples of runs), `stopping` (the number of runs, and exact intervals for a number of
runs that depends on them), `deciding` (tests between two hypotheses), `means` (intervals for expectations),
`estimate` (answers to queries).
"""
