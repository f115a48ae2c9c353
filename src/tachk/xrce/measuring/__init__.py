"""What captures say of the parameters of clients, Agents and networks.

`conversation` puts the messages of a stream in order as its sender sees them; `heartbeats`, `traffic` and `sleeps`
measure there what `quantity` describes; `settings` says what it amounts to as constants of a model; `measure` does all.
"""
