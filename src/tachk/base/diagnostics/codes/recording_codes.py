"""Explanations of what is reported about the ``recording { ... }`` of a model."""

from __future__ import annotations

from tachk.base.diagnostics.explanation import Explanation

RECORDING_CODES: dict[str, Explanation] = {
    "E0450": Explanation(
        "said twice",
        "A model says once how recordings are read, and once how exact their times are.",
        "chan a; recording { visible a as a(); late 2; late 3; }",
        "chan a; recording { visible a as a(); late 3; }",
    ),
    "E0451": Explanation(
        "nothing visible",
        "Without a visible channel there is nothing in a recording that could be held against the model.",
        "chan call; recording { hidden call; }",
        "chan send, call; recording { visible send as sent(); hidden call; }",
    ),
    "E0452": Explanation(
        "no such process to replace",
        "`replaces` names processes of the system line, or templates of which all processes are meant.",
        "chan a; recording { replaces R; visible a as a(); }",
        "chan a; recording { replaces P; visible a as a(); }",
    ),
    "E0453": Explanation(
        "duration that cannot be told in time units",
        "A duration with a unit needs a model that says how long its time unit is.",
        "chan a; recording { visible a as a(); tolerance 5 ms; }",
        "time_unit = 1 ms; chan a; recording { visible a as a(); tolerance 5 ms; }",
    ),
    "E0454": Explanation(
        "index of a visible channel",
        "Each index of a visible channel is a constant, or a new name, which stands for what the event tells. After "
        "`per` stand such names.",
        "chan send[3]; int n; recording { visible send[n + 1] as sent(n); }",
        "chan send[3]; recording { visible send[k] as sent(k); }",
    ),
    "E0455": Explanation(
        "index that no column tells",
        "Which channel of an array an event belongs to must be told by one of its columns.",
        "chan send[2][3]; recording { visible send[link][kind] as sent(kind); }",
        "chan send[2][3]; recording { visible send[link][kind] as sent(link, kind); }",
    ),
}
