"""Explanations of what elaboration reports: names, constants, types, templates, systems, queries."""

from __future__ import annotations

from tachk.base.diagnostics.codes.name_codes import NAME_CODES
from tachk.base.diagnostics.codes.recording_codes import RECORDING_CODES
from tachk.base.diagnostics.codes.system_codes import SYSTEM_CODES
from tachk.base.diagnostics.codes.type_codes import TYPE_CODES
from tachk.base.diagnostics.explanation import Explanation

MODEL_CODES: dict[str, Explanation] = {**NAME_CODES, **TYPE_CODES, **SYSTEM_CODES, **RECORDING_CODES}
