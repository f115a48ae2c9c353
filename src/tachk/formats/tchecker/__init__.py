"""TChecker's format.

`reader` reads it, with `expression_reader`. `writer` writes a network: `leaves` says what becomes of arrays and
records, `edge_expansion` what of edges, `label_writer` and `expression_writer` what of queries and expressions.
"""
