"""The verdicts of the models of the gallery: found at the build, and kept in a file until models or code change."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from docs.site_build.site_files import ROOT

KEPT = ROOT / "build/site-cache"
"""The folder of what is kept between builds."""

_ENDINGS = (".py", ".so", ".dylib", ".pyd", ".toml", ".lark")


@dataclass(frozen=True, slots=True)
class Answered:
    """Attributes:
    name: of the property.
    meaning: its title.
    answer: the verdict; with the values for `sup` and `inf`.
    met: the answer is the expected one; None where there is none.
    states: stored by the search.
    run: the run that shows the answer as text; empty where there is none, or where it is of no interest.
    """

    name: str
    meaning: str
    answer: str
    met: bool | None
    states: int
    run: str


@dataclass(frozen=True, slots=True)
class ModelVerdicts:
    """Attributes:
    constants: of the model, with their values.
    answers: in the order of the properties.
    """

    constants: Mapping[str, int]
    answers: tuple[Answered, ...]

    def summary(self) -> str:
        """How many properties hold, fail, or are something else."""
        if not self.answers:
            return "no properties of its own"
        counts: dict[str, int] = {}
        for each in self.answers:
            kind = each.answer if each.answer in ("holds", "fails", "unknown") else "measured"
            counts[kind] = counts.get(kind, 0) + 1
        return ", ".join(f"{counts[kind]} {_verb(kind, counts[kind])}" for kind in counts)


def _verb(kind: str, count: int) -> str:
    if count > 1:
        return kind
    return {"holds": "holds", "fails": "fails"}.get(kind, kind)


def find_verdicts(path: Path) -> ModelVerdicts:
    """Checks every property of a model, with the options of `tachk verify`."""
    import tachk

    model = tachk.load(path)
    report = model.verify()
    answers = []
    for verdict, row in zip(report, report.to_rows(), strict=False):
        failed = verdict.answer is tachk.Answer.FAILS
        run = report.run(verdict.query.name) if failed else None
        answer = str(row["values"] or verdict.answer)
        states = row["states_stored"]
        answers.append(
            Answered(
                verdict.query.name,
                verdict.query.title,
                answer,
                verdict.met,
                states if isinstance(states, int) else 0,
                "" if run is None else run.to_text(),
            )
        )
    return ModelVerdicts(dict(model.constants), tuple(answers))


def kept_verdicts(paths: Iterable[Path], folder: Path = KEPT) -> dict[Path, ModelVerdicts]:
    """The verdicts of models; those that were found before with the same models and the same code are read."""
    paths = tuple(paths)
    code = _hash_of(each for each in sorted((ROOT / "src/tachk").rglob("*")) if each.suffix in _ENDINGS)
    folder.mkdir(parents=True, exist_ok=True)
    found = {}
    for path in paths:
        around = _hash_of(sorted((ROOT / "models").rglob("*.ta")))
        file = folder / f"{path.stem}-{hashlib.sha256(f'{path.name} {around} {code}'.encode()).hexdigest()[:20]}.json"
        if not file.is_file():
            for old in folder.glob(f"{path.stem}-*.json"):
                old.unlink()
            file.write_text(json.dumps(asdict(find_verdicts(path))), encoding="utf-8")
        found[path] = _read(json.loads(file.read_text(encoding="utf-8")))
    return found


def _read(stored: dict[str, object]) -> ModelVerdicts:
    constants, answers = stored["constants"], stored["answers"]
    assert isinstance(constants, dict)
    assert isinstance(answers, list)
    return ModelVerdicts(constants, tuple(Answered(**each) for each in answers))


def _hash_of(paths: Iterable[Path]) -> str:
    together = hashlib.sha256()
    for path in paths:
        together.update(path.name.encode())
        together.update(path.read_bytes())
    return together.hexdigest()
