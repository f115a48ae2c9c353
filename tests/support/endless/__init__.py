"""Runs that go on for ever, where not all of them count: those in which time diverges, and those that recur."""
