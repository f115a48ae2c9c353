"""Answers and runs in another way than a search of zones gives them: a `second_engine`, and runs at another `pace`."""
