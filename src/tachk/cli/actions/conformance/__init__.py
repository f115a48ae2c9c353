"""`tachk conform`: a recording held against a model."""
