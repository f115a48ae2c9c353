"""From tachk's additions to the language to plain UPPAAL, syntax tree to syntax tree.

`expansion` is the whole; `value_passing` and `free_names` are its parts; `observer_templates` writes
properties as templates, with `mirrors` for what only an edge can see; `plain_model` is the result.
"""
