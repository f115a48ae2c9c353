"""The signal of a rule that the grammar itself cannot express."""

from __future__ import annotations

from tachk.base.diagnostics.diagnostic import Diagnostic


class Misplaced(Exception):
    """Something well-formed stands where it must not; caught by the parser, which goes on behind it."""

    def __init__(self, diagnostic: Diagnostic) -> None:
        self.diagnostic = diagnostic
        super().__init__(diagnostic.message)
