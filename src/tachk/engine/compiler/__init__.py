"""From a typed network to the program that the core executes.

In order of reading: `lower` (the whole), `slot_layout`, `condition_code`, `codegen` and `functions` (code for the
machine of `bytecode`), `bounds` and `goal`, `features` (what the core cannot do), `program` (the result).
"""
