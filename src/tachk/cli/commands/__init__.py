"""The commands: one module each, called like the command, with its options and its help.

They import nothing heavy. What a command does stands in `tachk.cli.actions`, or here where it is a few lines.
"""
