"""The meaning of a network, written to be read and to judge: nothing here is shared with the compiler or the core.

In order of reading: `discrete` (transitions and their order), `step` (one concrete run), `constraints` and `dbm`
(zones, as in textbooks), `symbolic` (successors of zones), `clock_constants`, `zones_of_run`. The `judge` checks runs
and certificates.
"""
