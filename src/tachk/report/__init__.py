"""What people and programs get to read. `record` is the outcome of a run, which every form of report takes.

`run` tells runs, `monitor` what monitors found; `quantity` and `json_text` say how numbers and JSON look everywhere.
"""
