"""What the core records of a run is what the semantics computes in its states: expressions of every kind, those that
never change among them."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from random import Random

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import InputError, UnsupportedError
from tachk.base.span import Source
from tachk.cli.main import app
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, RecordedChanges, SimulationOptions
from tachk.formats.loading.load import load_model
from tachk.frontend.loaded import LoadedModel
from tachk.frontend.queries.queries import is_statistical
from tachk.frontend.queries.statistical import StatisticalReader
from tachk.meaning.run_view import RunNames
from tachk.model.floating import DOUBLE
from tachk.model.statistical import Trajectories
from tachk.recordings.traces.trace import Trace
from tachk.simulation.columns import Column, all_columns
from tachk.simulation.runs import Runs, steps_of
from tachk.simulation.statistics.estimate import DrawnRuns
from tachk.simulation.stepping.replaying import replay_submitted
from tachk.simulation.stepping.run_file import read_run_file, steps_text
from tachk.simulation.stepping.signals import signals_of
from tachk.verify.questions import Questions

pytestmark = pytest.mark.drawn

DECLARATIONS = """
const int K = 3, L = -2, U[3] = {4, -5, 6};
typedef struct { int[-9, 9] a; bool b; } pair_t;
int[-40, 40] n = 1, still = 2;
int[-40, 40] a[3] = {1, 2, 3}, fixed[2] = {7, -8};
bool flag, always = true;
pair_t r = {3, true}, q = {-4, false};
double d = 0.5, e = 2.0;
const double C = 1.25;
clock x;
int twice(int k) { return 2 * k; }
int seven() { return 7; }
bool positive(int k) { return k > 0; }
int total() { int s = 0; for (i : int[0, 2]) s += a[i]; return s; }
double half(int k) { return k / 2.0; }
"""

PROCESSES = """
process P() {
    init location s { invariant x <= 3; to s { guard x >= 1; assign %s, x = 0; } to t { assign %s; } }
    location t { exponential_rate 2; to s { assign %s, x = 0; } }
}
process Q() { init location only { exponential_rate 1; to only { assign %s; } } }
system P, Q;
"""

UPDATES = (
    "n = (n + 1) % 5",
    "a[n % 2] = n",
    "a[2] = a[0]",
    "flag = !flag",
    "r.a = n % 4",
    "r.b = flag",
    "d = d * 2",
    "d = 0.1 * n",
)


class Expressions:
    """Random ones, as text; `fixed` leaves out what can change."""

    def __init__(self, random: Random) -> None:
        self.random = random
        self.fixed = False

    def leaf(self, known: str, changing: str) -> str:
        """One of these words."""
        return self.random.choice((known if self.fixed or self.random.random() < 0.5 else changing).split())

    def integer(self, depth: int = 2) -> str:
        if depth == 0 or self.random.random() < 0.3:
            known = "0 5 -3 K L still U[1] U[2] fixed[0] fixed[1] q.a twice(K) seven()"
            return self.leaf(known, "n a[0] a[n%2] r.a twice(n) total()")
        left, right = self.integer(depth - 1), self.integer(depth - 1)
        return self.random.choice(
            (
                f"({left} {self.random.choice('+-*&|^')} {right})",
                f"({left} {self.random.choice(('<?', '>?'))} {right})",
                f"-({left})",
                f"abs({left})",
                f"({self.truth(depth - 1)} ? {left} : {right})",
                f"(sum(i : int[0, 2]) (i * {left}))",
                f"({left} % 7)",
                f"fint({self.floating(0)})",
            )
        )

    def truth(self, depth: int = 2) -> str:
        if depth == 0 or self.random.random() < 0.2:
            known = "true false always q.b Q.only positive(K) positive(L)"
            return self.leaf(known, "flag r.b P.s P.t positive(n)")
        left, right = self.truth(depth - 1), self.truth(depth - 1)
        operator = self.random.choice(("<", "<=", "==", "!=", ">", ">="))
        return self.random.choice(
            (
                f"({left} && {right})",
                f"({left} || {right})",
                f"({left} imply {right})",
                f"!{left}",
                f"({self.integer(depth - 1)} {operator} {self.integer(depth - 1)})",
                f"({self.floating(depth - 1)} {operator} {self.floating(depth - 1)})",
                f"(forall(i : int[0, 2]) (U[i] < {self.integer(depth - 1)}))",
                f"(exists(i : int[0, 2]) (U[i] == {self.integer(depth - 1)}))",
            )
        )

    def floating(self, depth: int = 2) -> str:
        if depth == 0 or self.random.random() < 0.4:
            return self.leaf("1.5 -0.25 C e 2.0*K half(K) half(L)", "d half(n) 0.5*n")
        left, right = self.floating(depth - 1), self.floating(depth - 1)
        return self.random.choice((f"({left} {self.random.choice('+-*')} {right})", f"-({left})", f"fabs({left})"))


def model(random: Random) -> tuple[str, str]:
    """A model with six signals, three of which never change, and a query for floating point numbers, of which no signal
    can be made."""
    expressions = Expressions(random)
    signals, numbers = [], []
    for number in range(6):
        expressions.fixed = number % 2 == 0
        value = expressions.truth() if number > 3 else expressions.integer()
        signals.append(f"signal s{number} = {value};\n")
        numbers.append(expressions.floating())
    text = DECLARATIONS + PROCESSES % tuple(random.choice(UPDATES) for _ in range(4)) + "".join(signals)
    return text, f"simulate [<=12] {{{', '.join(numbers)}}}"


def columns(trace: Trace) -> dict[str, list[float]]:
    return {name: values.tolist() for name, values in trace.columns.items()}


def all_values(loaded: LoadedModel, query: str) -> tuple[Column, ...]:
    (asked,) = Questions("", (), (), (Source("<query>", query),)).about(loaded)
    assert is_statistical(asked)
    question = StatisticalReader(loaded).read(asked).question
    assert isinstance(question, Trajectories)
    own = (Column(value.span.text, value, floating=value.type == DOUBLE) for value in question.values)
    return (*all_columns(loaded.network), *own)


def compare(text: str, query: str, seed: int) -> int:
    """The number of rows of runs of a model, and of the replay of the same runs, which have to be equal."""
    loaded = load_model(Source("<text>", text), keeps_doubles=True)
    network = loaded.network
    runs, names = Runs(network, all_values(loaded, query)), RunNames(network)
    rows = 0
    drawing = SimulationOptions(seed, 12 * TICKS_PER_UNIT, steps=12)
    for run in runs.draw(drawing, range(2), RecordedChanges(actions=True, observed=True)):
        if run.fault is not None:
            continue
        replayed = replay_submitted(names, read_run_file(Source("a.run", steps_text(names, steps_of(run)))))
        assert replayed.refusal is None
        expected = signals_of(names, runs.columns, replayed.trace, "a", Fraction(run.end, TICKS_PER_UNIT)).trace
        assert columns(runs.trace(run)) == columns(expected), text
        assert runs.trace(run).times.tolist() == expected.times.tolist()
        rows += expected.rows
    return rows


def campaign(count: int, seed: int) -> tuple[int, int]:
    """How many models were compared, and how many rows; `python -c` runs a longer one."""
    models = rows = 0
    for number in range(count):
        try:
            rows += compare(*model(Random(seed + number)), number)
        except (InputError, UnsupportedError):
            continue
        models += 1
    return models, rows


def test_columns_are_those_of_the_replay() -> None:
    models, rows = campaign(40, seed=7100)
    assert models >= 30
    assert rows > 300


CONSTANT = """
const int LIMIT = 4;
int level = 1;
clock x;
process A() { init location s { invariant x <= 5; to t { } } location t; }
signal low = level < LIMIT;
signal room = LIMIT - level;
system A;
property steady : G (low && room == 3);
"""


def test_signals_that_never_change_in_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model = tmp_path / "a.ta"
    model.write_text(CONSTANT)
    for name in ("a.csv", "a.jsonl", "a.vcd", "a.parquet"):
        command = ["simulate", str(model), "--until", "8", "--seed", "4", "--record", "low", "--record", "room"]
        assert app.main([*command, "-o", str(tmp_path / name)], standalone_mode=False) == 0
    assert (tmp_path / "a.csv").read_text().splitlines()[1:] == ["0,0,1,3", "0,8,1,3"]
    lines = [json.loads(line) for line in (tmp_path / "a.jsonl").read_text().splitlines()]
    assert [(line["low"], line["room"]) for line in lines] == [(True, 3)] * 2
    assert "b11 " in (tmp_path / "a.vcd").read_text()
    capsys.readouterr()
    command = ["simulate", str(model), "--until", "8", "--runs", "3", "--monitor", str(model)]
    assert app.main(command, standalone_mode=False) == 0
    assert "steady: true on 3" in capsys.readouterr().out


def test_constants_in_scripts() -> None:
    model = tachk.loads(CONSTANT)
    (run,) = tachk.simulate(model, until=8)
    assert (run["low"].tolist(), run["room"].tolist()) == ([True] * len(run.times), [3.0] * len(run.times))
    (drawn,) = model.estimate("simulate [<=8] {level, 2 * level, level < LIMIT, 0.5 * level}")
    assert isinstance(drawn, DrawnRuns)
    assert [line.values.tolist() for line in drawn.runs[0].lines] == [[1, 1], [2, 2], [1, 1], [0.5, 0.5]]
