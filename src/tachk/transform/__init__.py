"""From a network to one with something more or less, and back for its runs."""
