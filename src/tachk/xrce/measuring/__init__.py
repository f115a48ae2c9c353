"""Parameters of clients, Agents and networks, measured in captures.

`conversation` puts the messages of a stream in order as its sender sees them; `heartbeats`, `traffic` and `sleeps`
measure there what `quantity` describes; `settings` says what it amounts to as constants of a model; `measure` does all.
"""
