"""Messages about texts: a `diagnostic` has a `span` and a code; `explanation` reads the explanations of codes."""
