"""The catalogue of sentences: for each pattern an example, its formula, the observer that watches it, its meaning.

The shapes of observers, by what they have to remember:

- S1 nothing: an invariant of one instant.
- S2 the oldest open trigger, with a clock: something has to come in time.
- S3 every open trigger: the window does not begin at the trigger.
- S4 the last trigger, with a clock: something must not come, or must stay, for a time.
- S5 whether the scope has begun.
- S6 whether, or how long ago, something has been.
- S7 the time since the last occurrence.
- S8 the time since a rise.
- S9 a stretch and a window at once.
- S10 what is awaited without a deadline: a run violates it by never ending to wait.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from tachk.base.span import Source
from tachk.logic.sentences import meaning
from tachk.syntax.formula import Formula
from tachk.syntax.sentences.parser import parse_sentence
from tachk.syntax.sentences.tree import Sentence


@dataclass(frozen=True, slots=True)
class Pattern:
    """Attributes:
    name: as the literature calls it, with what distinguishes it.
    example: a sentence.
    formula: what the example means, in the syntax of formulas.
    shape: of the observer, ``S1`` to ``S10``; empty where there is none and runs can only be monitored.
    meaning: in one line.
    """

    name: str
    example: str
    formula: str
    shape: str
    meaning: str

    @property
    def sentence(self) -> Sentence:
        return _read(self.example)

    @property
    def tree(self) -> Formula:
        return meaning(self.sentence)


@cache
def _read(text: str) -> Sentence:
    sentence, found = parse_sentence(Source("catalogue", text))
    assert sentence is not None, found
    return sentence


@dataclass(frozen=True, slots=True)
class Family:
    title: str
    patterns: tuple[Pattern, ...]


CATALOGUE: tuple[Family, ...] = (
    Family(
        "Always, never, once",
        (
            Pattern("universality", "p must be true.", "G p", "S1", "p at every instant"),
            Pattern("absence", "p must not occur.", "G !p", "S1", "p at no instant"),
            Pattern("existence", "p must occur.", "F p", "S10", "p at some instant"),
            Pattern(
                "bounded existence",
                "p must occur within 5 s.",
                "F[0, 5 s] p",
                "S7",
                "p at some instant of the first 5 s",
            ),
            Pattern(
                "initial response",
                "Initially, within 5 s, q must be true.",
                "F[0, 5 s] q",
                "S7",
                "the same, as the answer to the start",
            ),
            Pattern(
                "bounded recurrence",
                "q must occur at least every 5 s.",
                "G F[0, 5 s] q",
                "S7",
                "from every instant on, q comes within 5 s",
            ),
        ),
    ),
    Family(
        "Response",
        (
            Pattern(
                "implication",
                "Whenever p is true, q must be true.",
                "G (p -> q)",
                "S1",
                "at every instant of p, q is true too",
            ),
            Pattern(
                "exclusion",
                "Whenever p is true, q must not occur.",
                "G (p -> !q)",
                "S1",
                "p and q are never true together",
            ),
            Pattern(
                "bounded response",
                "Whenever p is true, within 5 s, q must be true.",
                "G (p -> F[0, 5 s] q)",
                "S2",
                "from every instant of p on, q comes within 5 s, both ends included",
            ),
            Pattern(
                "bounded response to an edge",
                "Whenever p becomes true, within 5 s, q must be true.",
                "G (rise(p) -> F[0, 5 s] q)",
                "S2",
                "after every rise of p, q comes within 5 s; p may last longer",
            ),
            Pattern(
                "response to a change",
                "Whenever x changes, within 5 s, q must be true.",
                "G (change(x) -> F[0, 5 s] q)",
                "S2",
                "after every change of the value of x, q comes within 5 s",
            ),
            Pattern(
                "response",
                "Whenever p is true, eventually, q must be true.",
                "G (p -> F q)",
                "S10",
                "after every instant of p comes one of q",
            ),
            Pattern(
                "delayed response",
                "Whenever p is true, between 2 and 5 s later, q must be true.",
                "G (p -> F[2 s, 5 s] q)",
                "S3",
                "from every instant of p on, q is true at some instant 2 s to 5 s later",
            ),
            Pattern(
                "exact response",
                "Whenever p is true, after 5 s, q must be true.",
                "G (p -> F[5 s, 5 s] q)",
                "S3",
                "5 s after every instant of p, q is true",
            ),
        ),
    ),
    Family(
        "How long a response lasts",
        (
            Pattern(
                "bounded invariance",
                "Whenever p is true, q must stay true for at least 5 s.",
                "G (p -> G[0, 5 s) q)",
                "S4",
                "from every instant of p on, q is true for 5 s or more",
            ),
            Pattern(
                "bounded absence",
                "Whenever p is true, q must not occur for 5 s.",
                "G (p -> G[0, 5 s] !q)",
                "S4",
                "from every instant of p on, q is not true for 5 s, both ends included",
            ),
            Pattern(
                "bounded absence after an edge",
                "Whenever p becomes true, q must not occur for 5 s.",
                "G (rise(p) -> G[0, 5 s] !q)",
                "S4",
                "after every rise of p, q is not true for 5 s",
            ),
            Pattern(
                "response of minimum duration",
                "Whenever p is true, within 5 s, q must stay true for at least 2 s.",
                "G (p -> F[0, 5 s] G[0, 2 s) q)",
                "S9",
                "from every instant of p on, a stretch of q of 2 s begins within 5 s",
            ),
            Pattern(
                "response of maximum duration",
                "Whenever p is true, within 5 s, q must stay true for at most 2 s.",
                "G (p -> F[0, 5 s] (q && F(0, 2 s] !q))",
                "S9",
                "within 5 s q is true and at most 2 s later it is not",
            ),
            Pattern(
                "response of bounded duration",
                "Whenever p is true, within 5 s, q must stay true for between 1 and 2 s.",
                "G (p -> F[0, 5 s] (G[0, 1 s) q && F[1 s, 2 s] !q))",
                "",
                "within 5 s q is true, stays so for 1 s, and becomes false at most 2 s later",
            ),
            Pattern(
                "response until",
                "Whenever p is true, q must stay true until r within 5 s.",
                "G (p -> q U[0, 5 s] r)",
                "S2",
                "from every instant of p on, q is true up to an r, which comes within 5 s",
            ),
            Pattern(
                "lasting response",
                "Whenever p is true, q must stay true from then on.",
                "G (p -> G q)",
                "S5",
                "from the first p on, q is always true",
            ),
            Pattern(
                "minimum duration",
                "Whenever p becomes true, p must stay true for at least 5 s.",
                "G (rise(p) -> G[0, 5 s) p)",
                "S8",
                "every stretch of p lasts 5 s or more",
            ),
            Pattern(
                "maximum duration",
                "Whenever p becomes true, p must stay true for at most 5 s.",
                "G (rise(p) -> F(0, 5 s] !p)",
                "S8",
                "every stretch of p lasts 5 s or less",
            ),
        ),
    ),
    Family(
        "What comes first",
        (
            Pattern(
                "precedence",
                "Whenever p is true, q must have been true.",
                "G (p -> O q)",
                "S6",
                "no p before the first q",
            ),
            Pattern(
                "bounded precedence",
                "Whenever p is true, q must have been true within the last 5 s.",
                "G (p -> O[0, 5 s] q)",
                "S6",
                "at every instant of p, q has been true at most 5 s ago",
            ),
        ),
    ),
    Family(
        "Triggers that last",
        (
            Pattern(
                "response to a minimum duration",
                "Whenever p becomes true and stays true for at least 3 s, within 5 s, q must be true.",
                "G (rise(p) && G[0, 3 s) p -> F[0, 5 s] q)",
                "S9",
                "q comes within 5 s of the rise of every stretch of p of 3 s or more",
            ),
            Pattern(
                "response to a minimum duration, from its end",
                "Whenever p becomes true and stays true for at least 3 s, counting from the end of min time, "
                "within 5 s, q must be true.",
                "G (rise(p) && G[0, 3 s) p -> F[3 s, 3 s] F[0, 5 s] q)",
                "S9",
                "q comes at most 5 s after p has been true for 3 s",
            ),
            Pattern(
                "response to a maximum duration",
                "Whenever p becomes true and stays true for at most 3 s, within 5 s, q must be true.",
                "G (rise(p) && F(0, 3 s] !p -> F[0, 5 s] q)",
                "S9",
                "q comes within 5 s of the rise of every stretch of p of 3 s or less",
            ),
            Pattern(
                "response to a maximum duration, from the fall",
                "Whenever p becomes true and stays true for at most 3 s, counting from the fall, within 5 s, "
                "q must be true.",
                "G (fall(p) && O(0, 3 s] rise(p) -> F[0, 5 s] q)",
                "S9",
                "q comes within 5 s of the fall of every stretch of p of 3 s or less",
            ),
            Pattern(
                "response to a maximum duration, from its end",
                "Whenever p becomes true and stays true for at most 3 s, counting from the end of max time, "
                "within 5 s, q must be true.",
                "G (rise(p) && F(0, 3 s] !p -> F[3 s, 3 s] F[0, 5 s] q)",
                "S9",
                "the same, counted from 3 s after the rise",
            ),
            Pattern(
                "response to a bounded duration",
                "Whenever p becomes true and stays true for between 1 and 3 s, within 5 s, q must be true.",
                "G (rise(p) && G[0, 1 s) p && F[1 s, 3 s] !p -> F[0, 5 s] q)",
                "S9",
                "q comes within 5 s of the rise of every stretch of p of 1 s to 3 s",
            ),
            Pattern(
                "response to a bounded duration, from the fall",
                "Whenever p becomes true and stays true for between 1 and 3 s, counting from the fall, within 5 s, "
                "q must be true.",
                "G (fall(p) && O[1 s, 3 s] rise(p) && H(0, 1 s] p -> F[0, 5 s] q)",
                "",
                "q comes within 5 s of the fall of every stretch of p of 1 s to 3 s",
            ),
        ),
    ),
    Family(
        "Scopes",
        (
            Pattern(
                "absence before",
                "Before R, p must not occur.",
                "F R -> !p U R",
                "S5",
                "no p before the first R, if there is one",
            ),
            Pattern(
                "absence after",
                "After Q, p must not occur.",
                "G (O Q -> !p)",
                "S5",
                "no p from the first Q on",
            ),
            Pattern(
                "absence between",
                "Between Q and R, p must not occur.",
                "G (Q && !R && F R -> !p U R)",
                "S5",
                "no p between a Q and the next R",
            ),
            Pattern(
                "absence after until",
                "After Q until R, p must not occur.",
                "G (Q && !R -> !p W R)",
                "S5",
                "no p from a Q on until the next R, even if that never comes",
            ),
            Pattern(
                "absence while",
                "While Q, p must not occur.",
                "G (Q -> !p)",
                "S1",
                "no p while Q is true",
            ),
            Pattern(
                "existence before",
                "Before R, p must occur.",
                "!R W (p && !R)",
                "S5",
                "R does not come before p has been",
            ),
            Pattern(
                "existence after",
                "After Q, p must occur.",
                "F Q -> F (Q && F p)",
                "S10",
                "if there is a Q, there is a p at or after it",
            ),
            Pattern(
                "existence between",
                "Between Q and R, p must occur.",
                "G (Q && !R -> !R W (p && !R))",
                "S5",
                "between a Q and the next R there is a p",
            ),
            Pattern(
                "existence after until",
                "After Q until R, p must occur.",
                "G (Q && !R -> !R U (p && !R))",
                "S10",
                "after a Q comes a p before the next R",
            ),
            Pattern(
                "bounded response before",
                "Before R, whenever p is true, within 5 s, q must be true.",
                "F R -> (p -> !R U[0, 5 s] (q && !R)) U R",
                "S2",
                "as long as R has not come, every p is answered by q within 5 s and before R",
            ),
            Pattern(
                "bounded response after",
                "After Q, whenever p is true, within 5 s, q must be true.",
                "G (O Q && p -> F[0, 5 s] q)",
                "S2",
                "from the first Q on, every p is answered by q within 5 s",
            ),
            Pattern(
                "bounded response between",
                "Between Q and R, whenever p is true, within 5 s, q must be true.",
                "G (Q && !R && F R -> (p -> !R U[0, 5 s] (q && !R)) U R)",
                "S2",
                "between a Q and the next R, every p is answered by q within 5 s and before R",
            ),
            Pattern(
                "bounded response after until",
                "After Q until R, whenever p is true, within 5 s, q must be true.",
                "G (Q && !R -> (p -> !R U[0, 5 s] (q && !R)) W R)",
                "S2",
                "the same, even if R never comes",
            ),
            Pattern(
                "bounded response while",
                "While Q, whenever p is true, within 5 s, q must be true.",
                "G (Q && p -> F[0, 5 s] q)",
                "S2",
                "every p during Q is answered by q within 5 s, which may be after Q",
            ),
            Pattern(
                "precedence between",
                "Between Q and R, whenever p is true, q must have been true.",
                "G (Q && !R && F R -> !p W (q || R))",
                "S6",
                "between a Q and the next R, no p before the first q",
            ),
            Pattern(
                "bounded recurrence between",
                "Between Q and R, q must occur at least every 5 s.",
                "G (Q && !R && F R -> F[0, 5 s] (q || R) U R)",
                "S7",
                "between a Q and the next R, q or R comes within 5 s from every instant on",
            ),
            Pattern(
                "bounded recurrence while",
                "While Q, q must occur at least every 5 s.",
                "G (Q -> F[0, 5 s] (q || !Q))",
                "S2",
                "during Q, q comes within 5 s from every instant on, or Q ends",
            ),
        ),
    ),
)


def patterns() -> tuple[Pattern, ...]:
    """All patterns in order."""
    return tuple(pattern for family in CATALOGUE for pattern in family.patterns)
