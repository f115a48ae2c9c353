"""`tachk check --deep`: what is odd about a model that no property asks for.

`deep_check` puts the parts together. One exploration serves most of them: `reached` reads from it the locations and
edges that nothing reaches, `guards` the guards that are the same everywhere, `stuck` the states from which nothing can
follow. `zeno` only looks at the model.
"""
