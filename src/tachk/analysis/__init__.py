"""What follows from the text of a network without a search: intervals, constant expressions, conditions, components."""
