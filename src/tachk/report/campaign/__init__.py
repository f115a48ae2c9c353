"""The tables of `tachk sweep`: `table` is the answer of the library, `text` and `heat_map` are forms for people."""
