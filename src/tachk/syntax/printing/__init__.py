"""From the syntax tree to text, comments kept.

`printer` is for files, `expression_printer` and `query_printer` for parts.
"""
