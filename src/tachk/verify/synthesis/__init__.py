"""For which values of constants a property holds.

`parameters` says which values are meant, `bounds_of_parameters` proves what a constant does to the behaviour, `walk`
chooses the cells that have to be decided, `cells` decides one, also by the
evidence of others, `inequalities` says a region in words, `region` is the
answer, and `synthesize` does it all.
"""
