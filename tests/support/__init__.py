"""For tests of engines: random networks, and the comparison of all engines on one of them."""

from tachk.model.random_networks import RandomCase, Shape, random_case
from tests.support.random_cases import cases

__all__ = ["RandomCase", "Shape", "cases", "random_case"]
