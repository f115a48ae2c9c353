"""Random models of processes that are interchangeable, or almost."""
