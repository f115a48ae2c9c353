"""From text to a syntax tree, and back.

`ast` and `formula` are the trees; `parsing`, `building` and `printing` are the ways between them and text.
"""
