"""TChecker's format: `reader` with `expression_reader`, `writer` with `label_writer` and `expression_writer`."""
