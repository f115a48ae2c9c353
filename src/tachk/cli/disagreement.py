"""The report of two strategies that contradict each other: all that is needed to find out which one is wrong."""

from __future__ import annotations

import json
import tempfile
from dataclasses import asdict
from pathlib import Path

from tachk.api import model as api
from tachk.report.answers import Report
from tachk.report.record import RunRecord
from tachk.verify.strategy import DisagreementError
from tachk.verify.verdict import Verdict


def write_disagreement(model: api.Model, error: DisagreementError) -> Path:
    """Writes the model, the query, the options and both answers, with their runs, to a new file."""

    def shown(verdict: Verdict) -> object:
        record = RunRecord(model.path, model.network, (verdict,), (), error.options, definitions=model.definitions)
        return Report(record).to_dict()

    path = Path(model.path)
    content = {
        "model": model.path,
        "text": path.read_text(encoding="utf-8") if path.is_file() else "",
        "constants": dict(model.constants),
        "query": error.query.text,
        "options": asdict(error.options),
        error.one.strategy: shown(error.one),
        error.other.strategy: shown(error.other),
    }
    with tempfile.NamedTemporaryFile(
        "w", prefix="tachk-disagreement-", suffix=".json", delete=False, encoding="utf-8"
    ) as file:
        json.dump(content, file, indent=2, default=str)
    return Path(file.name)
