"""Sets of states that show an answer, for plug-ins that hand them to other checkers."""

from __future__ import annotations

from tachk.meaning.judge.certificate import StateBlock
from tachk.transform.observed import observed
from tachk.verify.certificates import find_proof, is_provable

__all__ = ["StateBlock", "find_proof", "is_provable", "observed"]
