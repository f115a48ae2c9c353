"""The model that everything else uses: `types`, typed `expressions`, the `network` and queries about it.

`evaluate` says what expressions mean, `traversal` walks over them, `variable_layout` numbers what a state consists of.
"""
