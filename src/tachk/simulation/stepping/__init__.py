"""Runs taken step by step: those that a file claims, and those that somebody chooses.

In order of reading: `claims` (what a file says of a run), `run_file` and `files` (reading and writing
such files), `reasons` (why a step cannot be taken), `replaying` (whether claims are a run), `refusals` (messages about
that), `offers` (what can happen next, and when), `session` (a run with its past and future), `signals` (a run as a
recording).
"""
