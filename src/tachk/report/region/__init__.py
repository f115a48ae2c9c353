"""The regions of `tachk synthesize`: `words` says what is common, `text`, `json` and `picture` are the forms."""
