"""A relay between clients and Agent that loses, delays and duplicates packets by rules.

In the order of reading: `rules` (what to do with which packets), `script` (text to rules), `counterexample` (a run of a
model to rules), `sightings` (what a datagram says), `decisions` (from arrivals to departures, without sockets and
clocks), `recording` (what went over the wire, as a capture), `relay` (the sockets).
"""
