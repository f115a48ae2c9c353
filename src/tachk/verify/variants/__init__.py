"""Answers and runs in another way: a `second_engine`, runs at another `pace`, and `non_zeno` runs only."""
