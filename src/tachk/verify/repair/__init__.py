"""Which changes of a model would make recordings runs of it.

`vocabulary` collects the words of a template, `proposals` makes edges of them, `extended_model` elaborates all of
them at once, `screening` tries them near the place where a recording leaves the model, `other_constants` tries other
values of constants, and `repair` puts the changes in order that make all recordings runs.
"""
