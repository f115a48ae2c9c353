"""The digest that identifies a network."""

from __future__ import annotations

import hashlib

from tachk.formats.network_json.network import network_to_json_text
from tachk.model.network import Network


def digest(network: Network) -> str:
    """The SHA-256 of its JSON."""
    return hashlib.sha256(network_to_json_text(network).encode()).hexdigest()
