"""What a network means, written to be read and to judge: nothing here is shared with the compiler or the core.

In order of reading: `timed_trace` (states and runs), `discrete` (transitions and their order), `step` (one concrete
run), `constraints` and `dbm` (zones, as in textbooks), `symbolic` (successors of zones), `clock_constants`,
`zones_of_run`.
"""
