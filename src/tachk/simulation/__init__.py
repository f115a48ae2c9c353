"""Simulated runs of models.

In order of reading: `columns` (what is recorded), `runs` (drawing runs, and traces of them), `tables` (files of runs),
`intervals` (what runs say about probabilities).
"""
