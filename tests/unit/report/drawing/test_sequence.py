"""Sequence charts: everything is drawn, and no text stands on another."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import combinations, pairwise
from random import Random
from xml.etree import ElementTree

import pytest

from tachk.report.drawing.sequence.chart import (
    Category,
    Chart,
    EnteredLocation,
    Event,
    Message,
    Moment,
    Note,
    Phase,
    begun,
)
from tachk.report.drawing.sequence.layout import ChartLabel, ChartLayout, TimeAxis, lay_out, overlap
from tachk.report.drawing.sequence.sequence_svg import draw_chart
from tests.support.seeds import seeds

SVG = "{http://www.w3.org/2000/svg}"


def random_chart(seed: int, events: int = 40) -> Chart:
    """Bursts and silences between two to four processes."""
    random = Random(seed)
    count = random.randint(2, 4)
    time = Fraction(0)
    made: list[Event] = []
    for number in range(events):
        time += random.choice((Fraction(0), Fraction(random.randint(1, 9), 10), Fraction(random.randint(1, 40))))
        time += random.choice((0, 0, 0, 0, 500))
        moment = Moment(time, 10 * number)
        if random.random() < 0.1:
            made.append(Note(random.choice([None, *range(count)]), moment, "something <happens> & ends"))
            continue
        if random.random() < 0.2:
            made.append(EnteredLocation(random.randrange(count), moment, random.choice(("Idle", "WaitingForAnAnswer"))))
            continue
        sender, receiver = random.sample(range(count), 2)
        late = [Moment(time + random.choice((0, Fraction(1, 3), 30)), 10 * number + n) for n in range(1, 3)]
        arrivals = tuple(sorted(late[: random.choice((0, 1, 1, 1, 2))]))
        label = random.choice(("WRITE_DATA 3", "ACKNACK 4 missing 5, 7..16", "HEARTBEAT 3..7", "x" * 90))
        category = random.choice(list(Category))
        again = random.random() < 0.3
        tag, lost = f"{number}", not arrivals and random.random() < 0.7
        made.append(Message(sender, (receiver,), moment, arrivals, label, label, category, again, tag, lost))
    phase = Phase(0, begun(made[3]), begun(made[9]), "asleep")
    return Chart(
        "a <chart>", "of & at random", "ms", tuple(f"process {n}" for n in range(count)), tuple(made), (phase,)
    )


@pytest.mark.parametrize("axis", list(TimeAxis))
@pytest.mark.parametrize("seed", seeds(range(6)))
def test_no_text_stands_on_another_and_everything_is_inside(seed: int, axis: TimeAxis):
    layout = lay_out(random_chart(seed), axis)
    texts = [*layout.labels, *layout.locations]
    assert [(one, other) for one, other in combinations(texts, 2) if overlap(one, other)] == []
    for label in texts:
        left, top, right, bottom = label.box
        assert (left >= 0, top >= 0, right <= layout.width, bottom <= layout.height) == (True,) * 4, label


@pytest.mark.parametrize("axis", list(TimeAxis))
@pytest.mark.parametrize("seed", seeds(range(3)))
def test_every_message_is_drawn_and_lost_ones_have_a_cross(seed: int, axis: TimeAxis):
    chart = random_chart(seed)
    layout = lay_out(chart, axis)
    assert [arrow.message for arrow in layout.arrows] == list(chart.messages)
    root = ElementTree.fromstring(draw_chart(layout).svg)
    lines = [line.get("class", "").split() for line in root.iter(f"{SVG}line")]
    heads = list(root.iter(f"{SVG}polygon"))
    lost = [message for message in chart.messages if message.is_lost]
    legend = 1 if lost else 0
    assert sum("cross" in line for line in lines) == 2 * (len(lost) + legend)
    under_way = sum(not message.arrivals and not message.is_lost for message in chart.messages)
    assert len(heads) == sum(len(message.arrivals) for message in chart.messages) + under_way
    assert [node.text for node in (root.find(f"{SVG}title"), root.find(f"{SVG}desc")) if node is not None] == [
        chart.title,
        chart.description,
    ]


def sent(layout: ChartLayout) -> list[float]:
    return [arrow.y for arrow in layout.arrows]


def message(time: int, arrives: int | None = None, order: int = 0) -> Message:
    arrivals = () if arrives is None else (Moment(Fraction(arrives), order + 1),)
    return Message(0, (1,), Moment(Fraction(time), order), arrivals, f"DATA {time}", is_lost=not arrivals)


def chart_of(*messages: Message) -> Chart:
    return Chart("t", "d", "ms", ("a", "b"), messages)


def test_to_scale_equal_times_are_equal_lengths_and_long_silences_are_left_out():
    layout = lay_out(chart_of(*(message(time, time) for time in (0, 10, 20, 40, 50, 60, 9000))), TimeAxis.SCALE)
    ys = sent(layout)
    steps = [b - a for a, b in pairwise(ys)]
    assert steps[0] == pytest.approx(steps[1])
    assert steps[2] == pytest.approx(2 * steps[0])
    assert len(layout.cuts) == 1
    assert "8940 ms" in [label.text for label in layout.labels]


def test_to_scale_what_happens_at_one_time_stands_one_below_the_other():
    entered = EnteredLocation(1, Moment(Fraction(3), 4), "Done")
    chart = replace(chart_of(message(3, 3, 0), message(3, 3, 2), message(9, 9, 6)), unit="ms")
    events = tuple(sorted((*chart.events, entered), key=begun))
    layout = lay_out(replace(chart, events=events), TimeAxis.SCALE)
    first, second, _ = sent(layout)
    (box,) = layout.locations
    assert second - first >= 6
    assert box.box[1] > second


def test_labels_keep_off_their_arrows():
    """Letters such as q reach 3 below the base line, the halo around them 1.5 further."""
    layout = lay_out(chart_of(message(0, 0), message(5, 5)))
    assert [arrow.y - label.y >= 4.5 for arrow, label in zip(layout.arrows, layout.labels, strict=False)] == [True] * 2


def test_compressed_what_arrives_later_stands_lower():
    first, second, third = lay_out(
        chart_of(message(0, 5, 0), message(1, 2, 2), message(4, None, 4)), TimeAxis.COMPRESSED
    ).arrows
    assert first.y < second.y < second.ends[0][1] < third.y < first.ends[0][1]
    assert third.ends[0][0] < second.ends[0][0], "a lost message does not get there"


def test_a_part_has_only_the_lifelines_that_do_something():
    chart = Chart("t", "d", "", ("a", "b", "c"), (message(1, 1), message(5, 5)), ())
    part = chart.part(Fraction(2), None).used()
    assert (part.lifelines, [m.label for m in part.messages]) == (("a", "b"), ["DATA 5"])
    assert chart.part(Fraction(6), None).used().events == ()


def test_what_was_sent_before_a_part_comes_in_from_above():
    copied = Message(0, (1,), Moment(Fraction(1)), (Moment(Fraction(2)), Moment(Fraction(8))), "CREATE_CLIENT")
    part = Chart("t", "d", "", ("a", "b"), (copied, message(7, 7)), ()).part(Fraction(5), None)
    came = part.messages[0]
    assert (came.label, came.is_under_way, came.arrivals) == ("copy of CREATE_CLIENT", True, (Moment(Fraction(8)),))
    texts = [label.text for label in lay_out(part, TimeAxis.COMPRESSED).labels]
    assert {"copy of CREATE_CLIENT sent before", "copy of CREATE_CLIENT comes"} <= set(texts)
    assert "5" not in texts, "nobody knows from the part when it was sent"
    assert Chart("t", "d", "", ("a", "b"), (copied,), ()).part(Fraction(9), None).events == ()


def test_the_end_of_a_long_arrow_has_a_label():
    others = [message(time, time) for time in range(2, 30)]
    late = Message(0, (1,), Moment(Fraction(1)), (Moment(Fraction(3, 2)), Moment(Fraction(30))), "CREATE_CLIENT")
    layout = lay_out(Chart("t", "d", "", ("a", "b"), (late, *others), ()), TimeAxis.COMPRESSED)
    assert [label.text for label in layout.labels if "CREATE" in label.text] == [
        "CREATE_CLIENT ×2",
        "CREATE_CLIENT comes again",
    ]


def noted(text: str, axis: TimeAxis = TimeAxis.COMPRESSED) -> tuple[ChartLabel, ChartLayout]:
    note = Note(None, Moment(Fraction(20), 1), text)
    layout = lay_out(Chart("", "", "ms", ("a", "b"), (message(0, 1), note, message(21, 22, 2))), axis)
    (said,) = [label for label in layout.labels if label.text == text]
    return said, layout


@pytest.mark.parametrize("axis", list(TimeAxis))
def test_a_wide_note_stays_beside_the_times(axis: TimeAxis):
    said, layout = noted("wider than from one lifeline to the other one", axis)
    assert said.box[0] >= max(label.box[2] for label in layout.labels if label.style == "time")


def test_what_comes_below_a_note_has_room():
    _, layout = noted("wider than from one lifeline to the other one")
    labels = {label.text: label.y for label in layout.labels}
    assert [labels[arrow.message.label] - arrow.y for arrow in layout.arrows] == [-5, -5]
