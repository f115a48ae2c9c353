"""Runs taken step by step: submitted runs in files, and runs that a user chooses.

In order of reading: `submitted` (the run in a file), `run_file` and `files` (reading and writing such files),
`reasons` (why a step cannot be taken), `replaying` (the replay of submitted runs), `rejections` (messages about their
rejection), `enabled` (the steps that are enabled, and when), `session` (a run with its past and future), `signals` (a
run as a recording).
"""
