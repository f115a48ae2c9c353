"""From queries to verdicts.

`strategies` holds the tables that decide verdicts: strategies in their order, each with the exactness of its answers.
`verify` is the way of a query; `plan` puts queries together that one search answers; `strategy` has the loop over a
table. The strategies themselves stand in `reachability` (with the witness of an answer), `over_approximations`,
`along_path`, `liveness`, `extremes` and `smt`. `deadlines` and `observed_liveness` turn other queries into queries of
`liveness`. Beside an answer `vacuity`, `momentary`, `momentary_answers` and `unexamined` give notes for users,
`time_optimal` a fastest or slowest run, and `certificates` a proof.
"""
