"""Conformance of a real system to a model: is a recording of the system a run of the model?

Read: `events` (what a recording is), `event_tables` (files of events), `event_streams` (events as synchronisations,
and the window of each), `trace_product` (the product of the model with trace automata),
`conform` (the search), `rejection` (why there is no run).
"""
