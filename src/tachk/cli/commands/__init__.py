"""The options of the commands, one module each, called like the command; nothing here imports anything heavy."""
