"""Random models of two halves that hardly touch: each sends over a lossy link, and both draw on one budget of losses.

What passes between sender, link and receiver are broadcasts with a meta variable; counters, flags and channels are
arrays with an element for each half. Now and then something joins the halves, or makes the budget none.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from random import Random


@dataclass(frozen=True)
class Halves:
    text: str
    queries: tuple[str, ...]


def random_halves(random: Random) -> Halves:
    def rarely(text: str, otherwise: str = "", share: float = 0.05) -> str:
        return text if random.random() < share else otherwise

    processes = [
        _sender(random, half, rarely) + _link(random, half, rarely) + _receiver(random, half, rarely) for half in (0, 1)
    ]
    order = [f"{name}{half}" for name in ("Sender", "Link", "Receiver") for half in (0, 1)]
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
    half = random.randint(0, 1)
    queries = (
        f"A[] got[{half}] <= sent[{half}]",
        f"A[] got[{half}] <= {random.randint(0, 2)}",
        f"E<> Receiver{half}.Done && got[{half}] {random.choice(['== 0', '> 2', '== 1'])}",
        f"E<> Sender{half}.Waiting && {random.choice(['losses == 0', f'sent[{half}] == 0', f'got[{half}] == 2'])}",
    )
    return Halves(text, queries)


def _sender(random: Random, half: int, rarely: Callable[..., str]) -> str:
    period = random.randint(1, 3)
    index = rarely("place", str(half))
    return f"""
    process Sender{half}() {{
        clock x;
        init location Idle {{
            invariant x <= {period}{rarely(" || losses >= 1")};
            to Idle {{
                guard x >= {random.randint(0, period)} && sent[{half}] < 3{rarely(" && losses < LOSSES")};
                sync send[{index}]!;
                assign number = sent[{half}], sent[{half}] = sent[{half}] + 1, x = 0;
            }}
            to Waiting {{ guard sent[{half}] == {random.randint(1, 3)}; {rarely(f"sync hand[{1 - half}]!;")} }}
            {rarely("to Idle { assign losses = 0; }")}
        }}
        {rarely("urgent ", share=0.2)}location Waiting {{
            to Idle {{ sync answer[{half}]?; assign x = 0; }}
            {rarely("to Idle { guard losses >= 1; assign x = 0, place = 1; }")}
        }}
    }}
    """


def _link(random: Random, half: int, rarely: Callable[..., str]) -> str:
    lost = random.choice(["losses < LOSSES", "can_lose()", "losses < LOSSES && !deaf[{0}]", "losses <= LOSSES - 1"])
    raised = random.choice(["losses = losses + 1", "losses += 1", "losses++"])
    deaf = f"to Empty {{ guard deaf[{half}]; sync send[{half}]?; }}"
    safe = random.choice(
        [
            f"to Full {{ sync send[{half}]?; assign kept = number; }}",
            f"to Full {{ guard !deaf[{half}]; sync send[{half}]?; assign kept = number; }} {deaf}",
            rarely(f"to Full {{ guard deaf[{half}]; sync send[{half}]?; }}", f"to Full {{ sync send[{half}]?; }}", 0.3),
        ]
    )
    return f"""
    process Link{half}() {{
        int[0, 3] kept = 0;
        init location Empty {{
            {safe}
            to Empty {{ guard {lost.format(half)}; sync send[{half}]?; assign {rarely("losses = 1", raised)}; }}
        }}
        {random.choice(["urgent ", "committed ", ""])}location Full {{
            to Empty {{ sync deliver[{half}]!; assign number = kept, kept = 0; }}
            {random.choice(["", f"to Full {{ sync send[{half}]?; }}"])}
        }}
    }}
    """


def _receiver(random: Random, half: int, rarely: Callable[..., str]) -> str:
    heard = rarely(str(1 - half), str(half))
    return f"""
    process Receiver{half}() {{
        clock y;
        init location Ready {{
            to Busy {{ sync deliver[{heard}]?; assign got[{half}] = number{rarely(" + 0 * losses")}, y = 0; }}
            to Ready {{ guard y > 2; assign deaf[{rarely("place", str(half))}] = !deaf[{half}], y = 0; }}
            to Done {{ guard got[{half}] == {random.randint(1, 2)}{rarely(" && losses == LOSSES")}; }}
            {rarely(f"to Done {{ sync hand[{half}]?; }}", share=0.2)}
        }}
        {random.choice(["committed ", "urgent ", ""])}location Busy {{
            to Ready {{ sync answer[{half}]!; assign number = got[{half}]; }}
        }}
        location Done;
    }}
    """
