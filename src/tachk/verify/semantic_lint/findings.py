"""Findings of a deep check, and questions that it could not decide."""

from __future__ import annotations

from dataclasses import dataclass

from tachk.base.diagnostics.diagnostic import Diagnostic, by_place
from tachk.engine.outcome import Statistics
from tachk.model.run import TimedTrace


@dataclass(frozen=True, slots=True)
class LintEvidence:
    """A finding with the run that shows it, which has been replayed."""

    finding: Diagnostic
    run: TimedTrace


@dataclass(frozen=True, slots=True)
class LintAnswer:
    """The answer to one question about a model.

    Attributes:
        question: in a few words, such as ``"time-locks"``.
        answer: in a few words, such as ``"none"`` or ``"2"``.
        findings: what is odd, each once for a template.
        evidence: the runs that show some of them.
        undecided: why the question is not (or not wholly) decided; empty where it is.
    """

    question: str
    answer: str
    findings: tuple[Diagnostic, ...] = ()
    evidence: tuple[LintEvidence, ...] = ()
    undecided: str = ""

    @property
    def in_words(self) -> str:
        """The answer, and why it is not the whole one."""
        return f"{self.answer} ({self.undecided})" if self.undecided else self.answer


@dataclass(frozen=True, slots=True)
class DeepCheck:
    """What an exploration of a whole model has found that no query asks for.

    Attributes:
        reason: why the exploration has not gone through everything; empty where it has.
    """

    parts: tuple[LintAnswer, ...]
    statistics: Statistics
    reason: str = ""

    @property
    def findings(self) -> tuple[Diagnostic, ...]:
        """All findings in the order of their places."""
        return by_place(finding for part in self.parts for finding in part.findings)

    @property
    def evidence(self) -> tuple[LintEvidence, ...]:
        """The runs that show findings."""
        return tuple(evidence for part in self.parts for evidence in part.evidence)

    @property
    def decided(self) -> bool:
        """True if every question is decided."""
        return not any(part.undecided for part in self.parts)

    def __str__(self) -> str:
        """A line for each question and for each finding."""
        width = max((len(part.question) for part in self.parts), default=0)
        lines = [f"{part.question:<{width}}  {part.in_words}" for part in self.parts]
        lines += [f"{finding.span}: {finding.code}: {finding.message}" for finding in self.findings]
        return "\n".join(lines)

    def __repr__(self) -> str:
        extent = f"{self.statistics.states_stored} states, then {self.reason}" if self.reason else "all states"
        return f"<DeepCheck of {extent}, findings: {counted(self.findings)}>"


def counted(findings: tuple[Diagnostic, ...]) -> str:
    """``"none"``, or how many."""
    return str(len(findings)) if findings else "none"
