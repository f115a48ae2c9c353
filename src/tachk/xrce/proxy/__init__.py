"""A relay between clients and Agent that loses, delays and duplicates packets by rules.

In the order of reading: `rules` (actions on packets), `fault_plan` (text to rules), `counterexample` (a run to
rules), `sightings` (the content of a datagram), `decisions` (from arrivals to departures, without sockets and clocks),
`recording` (the relayed packets, as a capture), `relay` (the sockets).
"""
