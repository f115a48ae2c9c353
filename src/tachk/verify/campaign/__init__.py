"""Campaigns: the same question about a model for every combination of values of some constants.

`grid` holds the combinations, `job` the questions about each, `store` keeps what is finished in a file, `local` and
`cluster` compute what is missing, and `run` puts them together.
"""
