"""Every diagnostic code with its explanation, for ``tachk explain CODE`` and the documentation.

The numbers: E00xx files and characters, E01xx syntax, E02xx names, E03xx types, E04xx templates and systems, E05xx
queries and properties, E06xx constants, E07xx unsupported features and run-time errors, E08xx the formats and versions
of other tools, E090x and E091x formulas over traces, E092x runs, E095x rules of a relay, W0xxx warnings.
"""

from __future__ import annotations

from tachk.base.diagnostics.codes.deep_codes import DEEP_CODES
from tachk.base.diagnostics.codes.export_codes import EXPORT_CODES
from tachk.base.diagnostics.codes.formula_codes import DURATION_CODES
from tachk.base.diagnostics.codes.lowering_codes import LOWERING_CODES
from tachk.base.diagnostics.codes.model_codes import MODEL_CODES
from tachk.base.diagnostics.codes.monitoring_codes import MONITORING_CODES
from tachk.base.diagnostics.codes.observer_codes import OBSERVER_CODES
from tachk.base.diagnostics.codes.proxy_codes import PROXY_CODES
from tachk.base.diagnostics.codes.run_time_codes import RUN_TIME_CODES
from tachk.base.diagnostics.codes.runs.run_codes import RUN_CODES
from tachk.base.diagnostics.codes.runs.statistics_codes import STATISTICS_CODES
from tachk.base.diagnostics.codes.runs.trace_codes import TRACE_CODES
from tachk.base.diagnostics.codes.sentence_codes import SENTENCE_CODES
from tachk.base.diagnostics.codes.syntax_codes import SYNTAX_CODES
from tachk.base.diagnostics.codes.verification_codes import VERIFICATION_CODES
from tachk.base.diagnostics.codes.xml_codes import XML_CODES
from tachk.base.diagnostics.explanation import Explanation

CODES: dict[str, Explanation] = {
    **SYNTAX_CODES,
    **SENTENCE_CODES,
    **STATISTICS_CODES,
    **XML_CODES,
    **MODEL_CODES,
    **DURATION_CODES,
    **LOWERING_CODES,
    **VERIFICATION_CODES,
    **RUN_TIME_CODES,
    **OBSERVER_CODES,
    **EXPORT_CODES,
    **DEEP_CODES,
    **MONITORING_CODES,
    **TRACE_CODES,
    **RUN_CODES,
    **PROXY_CODES,
}


def explain(code: str) -> str | None:
    """The explanation of a code as text, or None if there is no such code."""
    explanation = CODES.get(code.upper())
    if explanation is None:
        return None
    parts = [f"{code.upper()}: {explanation.title}", explanation.why]
    if explanation.bad:
        parts.append("Wrong:\n\n" + _indented(explanation.bad))
    if explanation.good:
        parts.append("Right:\n\n" + _indented(explanation.good))
    return "\n\n".join(parts)


def _indented(text: str) -> str:
    return "\n".join("    " + line if line else "" for line in text.splitlines())
