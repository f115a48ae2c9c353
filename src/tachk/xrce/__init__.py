"""DDS-XRCE on the wire: from captures of packets to events."""
