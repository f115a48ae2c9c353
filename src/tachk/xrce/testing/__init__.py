"""Real clients and Agents of DDS-XRCE as systems under test."""
