"""Requirements in English.

In order of reading: `tree` (what a sentence is), `text`, `tables` and `parses` (how words are read), `build`,
`conditions` and `order`, `parser` (the whole), `similar_phrases` (what may have been meant), `printer`.
"""
