"""Requirements in English.

In order of reading: `tree` (what a sentence is), `text`, `tables` and `readings` (how words are read), `build`,
`conditions` and `order`, `parser` (the whole), `near` (what may have been meant), `printer`.
"""
