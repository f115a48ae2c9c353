"""The seed of everything random where none is given: each command and function draws the same without one."""

from __future__ import annotations

from typing import Final

DEFAULT_SEED: Final = 0
