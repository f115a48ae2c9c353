"""From a formula to the nondeterministic observer that reaches a location where the formula is violated.

In order of reading: `violation` (what has to be seen), `goals` and `tableau` (how to see it), `states`, `conditions`,
`ways`, `names`; `construction` puts a template together.
"""
