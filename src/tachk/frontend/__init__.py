"""From a syntax tree to a typed network with its queries: `elaborate` is the whole, `loaded` the result."""
