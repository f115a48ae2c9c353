"""Models and certificates for Munta, a checker of timed automata that is proved correct in Isabelle/HOL.

Munta (S. Wimmer, P. Lammich, Verified model checking of timed automata, TACAS 2018; S. Wimmer, J. von Mutius, Verified
certification of reachability checking for timed automata, TACAS 2020) reads networks whose guards compare one variable
or clock with a number. `cases` and `actions` bring the edges of a network into that form, `writer` makes the model, and
`proofs` and `certificate` its sets of states. tachk calls `writer.to_muntax` and `proofs.write_proofs`.
"""

__version__ = "0.1.0"
