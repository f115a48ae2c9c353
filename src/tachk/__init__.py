"""Model checking of networks of timed automata.

``tachk.load("train.ta", N=3).verify()`` reads a model, instantiates it and checks its properties; see `tachk.api`.
"""

__version__ = "0.1.0"
