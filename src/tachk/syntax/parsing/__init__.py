"""From text to a parse.

In order of reading: `parser` (the entry), `tokens` and `contextual` (words), `grammar`, `compile_grammar`, `lalr` and
`tables` (the automaton), `driver` (the parse, with recovery), `situation`, `messages` and `foreign_words` (what to say
of a mistake); `legacy`, `old_precedence` and `strict` are dialects.
"""
