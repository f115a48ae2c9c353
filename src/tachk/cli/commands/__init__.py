"""The commands: one module each, called like the command, with its options, its help and what it does."""
