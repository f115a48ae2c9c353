"""From queries to answers: `plan` says what has to be searched for, `verify` searches, `verdict` is the answer.

`fault_explanation` makes a run-time error into a run.
"""
