"""What a set of requirements says about itself, before there is a model: `tachk requirements`.

In order of reading: `signals` (what they speak of), `rules` (requirements that tell at any time what may come next),
`world` (a model of everything that may happen), `analysis` (the questions).
"""
