"""The analysis of requirements before there is a model: `tachk requirements`.

In order of reading: `signals` (the signals in them), `rules` (requirements that say at any time what may come next),
`world` (a model of everything that may happen), `analysis` (the questions).
"""
