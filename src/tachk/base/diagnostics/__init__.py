"""What is said about a text, and where: a `diagnostic` has a `span` and a code; `explanation` reads what codes mean."""
