"""The actions of commands, each loaded when its arguments are read."""
