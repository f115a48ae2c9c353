"""Random models of two components that hardly touch: each sends over a lossy link, and both count losses together.

What passes between sender, link and receiver are broadcasts with a meta variable; counters, flags and channels are
arrays with an element for each component. Now and then something joins them, or makes the counter none.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from random import Random

from tachk.api.model import Model, loads
from tachk.engine.options import Limits, Options
from tachk.verify.verdict import Answer, Verdict


@dataclass(frozen=True)
class IndependentComponents:
    text: str
    queries: tuple[str, ...]


def random_components(random: Random) -> IndependentComponents:
    def rarely(text: str, otherwise: str = "", share: float = 0.05) -> str:
        return text if random.random() < share else otherwise

    processes = [
        _sender(random, own, rarely) + _link(random, own, rarely) + _receiver(random, own, rarely) for own in (0, 1)
    ]
    order = [f"{name}{own}" for name in ("Sender", "Link", "Receiver") for own in (0, 1)]
    random.shuffle(order)
    text = f"""
    const int LOSSES = {random.randint(1, 2)};
    int[0, {rarely("3", "LOSSES", 0.3)}] losses = {rarely("1", "0")};
    meta int[0, 3] number = 0;
    int[0, 3] sent[2];
    int[0, 3] got[2];
    bool deaf[2];
    int[0, 1] place = 0;
    {rarely("urgent ")}broadcast chan send[2];
    {rarely("urgent ")}broadcast chan deliver[2];
    broadcast chan answer[2];
    chan hand[2];
    bool can_lose() {{ return losses < LOSSES; }}
    {"".join(processes)}
    system {", ".join(order)};
    """
    own = random.randint(0, 1)
    waits = f"Sender{own}.Waiting"
    queries = (
        f"A[] got[{own}] <= sent[{own}]",
        f"A[] got[{own}] <= {random.randint(0, 2)}",
        f"E<> Receiver{own}.Done && got[{own}] {random.choice(['== 0', '> 2', '== 1'])}",
        f"E<> Sender{own}.Waiting && {random.choice(['losses == 0', f'sent[{own}] == 0', f'got[{own}] == 2'])}",
        random.choice(["E<> deadlock", f"A<> Receiver{own}.Done", f"{waits} --> Sender{own}.Idle", f"E[] !{waits}"]),
    )
    return IndependentComponents(text, queries)


@dataclass(frozen=True)
class Comparison:
    """What searches told of one model with and without leaving out a part of it.

    Attributes:
        problems: what must not be.
        compared: queries that both searches answered.
        fewer: queries that took fewer states where a part was left out.
        faults: queries about which a search of the whole met a run-time error.
    """

    problems: tuple[str, ...]
    compared: int
    fewer: int
    faults: int


def compare(case: IndependentComponents, limits: Limits) -> Comparison:
    """Whether leaving out a part of a model changes an answer, or hides a run-time error without saying so."""
    model = loads(case.text)
    everything = Options().off("unblocked", "sliced", "cone")
    pairs = list(zip(_answers(model, case, Options(), limits), _answers(model, case, everything, limits), strict=True))
    problems = tuple(problem for part, whole in pairs for problem in _problems(part, whole))
    return Comparison(
        problems,
        sum(not part.reason and not whole.reason and whole.fault is None for part, whole in pairs),
        sum(part.statistics.states_stored < whole.statistics.states_stored for part, whole in pairs),
        sum(whole.fault is not None for _, whole in pairs),
    )


def _answers(model: Model, case: IndependentComponents, options: Options, limits: Limits) -> list[Verdict]:
    return [verdict for query in case.queries for verdict in model.verify(query, options=options, limits=limits)]


def _problems(part: Verdict, whole: Verdict) -> list[str]:
    if part.answer is Answer.UNKNOWN:
        return []
    told = f"{part.query.text}: {part.answer} without a part, {whole.answer} with it"
    if whole.fault is not None and part.trace is None and not part.unexamined:
        return [f"{told}: a run-time error is hidden"]
    if whole.answer not in (Answer.UNKNOWN, part.answer):
        return [told]
    if whole.answer is part.answer and (part.trace is None) != (whole.trace is None):
        return [f"{told}: only one of them shows a run"]
    return []


def _sender(random: Random, own: int, rarely: Callable[..., str]) -> str:
    period = random.randint(1, 3)
    index = rarely("place", str(own))
    return f"""
    process Sender{own}() {{
        clock x;
        init location Idle {{
            invariant x <= {period}{rarely(" || losses >= 1")};
            to Idle {{
                guard x >= {random.randint(0, period)} && sent[{own}] < 3{rarely(" && losses < LOSSES")};
                sync send[{index}]!;
                assign number = sent[{own}], sent[{own}] = sent[{own}] + 1, x = 0;
            }}
            to Waiting {{ guard sent[{own}] == {random.randint(1, 3)}; {rarely(f"sync hand[{1 - own}]!;")} }}
            {rarely("to Idle { assign losses = 0; }")}
        }}
        {rarely("urgent ", share=0.2)}location Waiting {{
            to Idle {{ sync answer[{own}]?; assign x = 0; }}
            {rarely("to Idle { guard losses >= 1; assign x = 0, place = 1; }")}
        }}
    }}
    """


def _link(random: Random, own: int, rarely: Callable[..., str]) -> str:
    lost = random.choice(["losses < LOSSES", "can_lose()", "losses < LOSSES && !deaf[{0}]", "losses <= LOSSES - 1"])
    lost = rarely("losses < LOSSES || deaf[sent[{0}]]", lost)
    raised = random.choice(["losses = losses + 1", "losses += 1", "losses++"])
    deaf = f"to Empty {{ guard deaf[{own}]; sync send[{own}]?; }}"
    safe = random.choice(
        [
            f"to Full {{ sync send[{own}]?; assign kept = number; }}",
            f"to Full {{ guard !deaf[{own}]; sync send[{own}]?; assign kept = number; }} {deaf}",
            rarely(f"to Full {{ guard deaf[{own}]; sync send[{own}]?; }}", f"to Full {{ sync send[{own}]?; }}", 0.3),
        ]
    )
    return f"""
    process Link{own}() {{
        int[0, 3] kept = 0;
        init location Empty {{
            {safe}
            to Empty {{ guard {lost.format(own)}; sync send[{own}]?; assign {rarely("losses = 1", raised)}; }}
        }}
        {random.choice(["urgent ", "committed ", ""])}location Full {{
            to Empty {{ sync deliver[{own}]!; assign number = kept, kept = 0; }}
            {random.choice(["", f"to Full {{ sync send[{own}]?; }}"])}
        }}
    }}
    """


def _receiver(random: Random, own: int, rarely: Callable[..., str]) -> str:
    received = rarely(str(1 - own), str(own))
    more = rarely(" + 0 * losses") + rarely(" + 1")
    return f"""
    process Receiver{own}() {{
        clock y;
        init location Ready {{
            to Busy {{ sync deliver[{received}]?; assign got[{own}] = number{more}, y = 0; }}
            to Ready {{ guard y > 2; assign deaf[{rarely("place", str(own))}] = !deaf[{own}], y = 0; }}
            to Done {{ guard got[{own}] == {random.randint(1, 2)}{rarely(" && losses == LOSSES")}; }}
            {rarely(f"to Done {{ sync hand[{own}]?; }}", share=0.2)}
        }}
        {random.choice(["committed ", "urgent ", ""])}location Busy {{
            to Ready {{ sync answer[{own}]!; assign number = got[{own}]; }}
        }}
        location Done;
    }}
    """
