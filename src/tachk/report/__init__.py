"""Rendering of results for people and programs. `record` is the outcome of a run, which every form of report takes.

`run` prints runs, `monitor` evaluated traces; `json_text` writes JSON, `drawing` makes pictures.
"""
