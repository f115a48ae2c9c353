"""Units for co-simulation: a network as a native unit for FMI 2.0 and 3.0.

In order of reading: `unit` (what the variables of a unit are), `resource_file` (the network as the library reads it),
`description` (modelDescription.xml), `archive` (the file that masters open).
"""
