"""The second engine: bounded model checking and induction with z3, made from the network and not from its program.

In order of reading: `terms` (numbers and truth values), `storage` and `machine` (what code does), `conditions`,
`relation` (one step of a network), `solving` (z3 and limits), `facts` (hypotheses of proofs), `search`.
"""
