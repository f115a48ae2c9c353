"""The commands: one module each, called like the command, with its options, its help and what it does.

The functions that do it import what is heavy themselves: help, wrong options and the completion of options wait for
nothing of it.
"""
