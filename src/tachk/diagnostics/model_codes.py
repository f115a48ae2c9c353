"""Explanations of what elaboration and lowering report: names, types, templates, queries, constants, features."""

from __future__ import annotations

from tachk.diagnostics.explanation import Explanation

MODEL_CODES: dict[str, Explanation] = {}
