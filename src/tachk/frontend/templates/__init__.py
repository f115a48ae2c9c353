"""Templates, their instances, rates of clocks, and edges that can never be taken."""
