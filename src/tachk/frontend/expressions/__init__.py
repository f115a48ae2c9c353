"""Expressions with types: `typed_expressions` is the entry; clocks have rules of their own in `clock_constraints`."""
