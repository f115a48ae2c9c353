"""The library: models, and what one asks of them and of recordings. Scripts find all of it in `tachk`."""
