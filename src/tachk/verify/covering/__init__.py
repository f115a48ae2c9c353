"""Test suites: a few runs that together take all edges of a network, or visit all of its locations."""
