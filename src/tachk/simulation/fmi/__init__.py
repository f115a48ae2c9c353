"""Units for co-simulation: a network as a native unit for FMI 2.0 and 3.0.

In order of reading: `unit` (what the variables of a unit are), `blueprint` (the file that the library of a unit reads),
`description` (modelDescription.xml), `archive` (the file that masters open).
"""
