"""Explanations of what is reported about sentences. The examples are sentences, not models."""

from __future__ import annotations

from tachk.base.diagnostics.explanation import Explanation

SENTENCE_CODES: dict[str, Explanation] = {
    "E0140": Explanation(
        "no sentence",
        "A sentence has a scope, a trigger, a delay and a response, in this order, and ends with a full stop. All but "
        "the response may be left out. `tachk sentences` lists all sentences, with examples.",
        "Whenever sleep is true.",
        "Whenever sleep is true, arrive must not occur.",
    ),
    "E0141": Explanation(
        "unknown phrase of a sentence",
        "Sentences are made of fixed phrases, so that each has one meaning. The words resemble one of them.",
        "When ever request is true, withn 5 s, grant must hold.",
        "Whenever request is true, within 5 s, grant must be true.",
    ),
    "E0142": Explanation(
        "parts of a sentence in the wrong order",
        "The order is: scope, trigger, delay, response.",
        "grant must be true within 5 s whenever request is true.",
        "Whenever request is true, within 5 s, grant must be true.",
    ),
    "E0143": Explanation(
        "delay without a trigger",
        "'Within 180 s, q must be true' can mean that q comes at the latest 180 s after the start, or that from every "
        "instant on it takes at most 180 s until q is true (again). 'Initially, within 180 s, ...' says the former, "
        "'q must occur at least every 180 s' the latter.",
        "Within 180 s, done must be true.",
        "Initially, within 180 s, done must be true.",
    ),
    "E0144": Explanation(
        "parts of a sentence that do not go together",
        "The parts are understood, but together they have no meaning, or more than one.",
        "Whenever sleep is true, within 50 s, arrive must not occur.",
        "Whenever sleep is true, arrive must not occur for 50 s.",
    ),
    "E0145": Explanation(
        "sentence with two readings",
        "Words such as 'and' can belong to the sentence or to a condition inside it. Parentheses or quotation marks "
        "around a condition make it one piece.",
        "Between p and q and r, s must be true.",
        "Between (p and q) and r, s must be true.",
    ),
    "E0146": Explanation(
        "temporal operator inside a condition",
        "The conditions of a sentence are about one instant: comparisons, and, or, not, rise, fall, change. Write a "
        "property that needs operators like F, G and U as a formula.",
        "Whenever G[0, 5] p is true, q must be true.",
        "Whenever p becomes true and stays true for at least 5, counting from the end of min time, q must be true.",
    ),
}
