"""Recorded traces, and monitors that run on them.

`trace` is a recording in memory, `trace_files` opens whatever it is kept in. `monitor_program` is a compiled formula.
`core_monitor` runs it over a whole trace, `linear_monitor` over lines between rows and in time, `online_monitor` on a
trace that grows; `verdict_explanation` says why it is false.
"""
