"""Holding recordings of a real system against a model: is the recording a run of it?

Read: `events` (what a recording is), `event_tables` (files of events), `queues` (which synchronisations the events are,
and when they may have happened), `followers` (the network of the model and of processes that follow the recording),
`conform` (the search), `refusal` (why there is no run).
"""
