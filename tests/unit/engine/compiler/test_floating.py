"""Floating point functions: the core, the plain machine and the evaluator compute the same, to the last bit."""

from __future__ import annotations

import ctypes
import itertools
import math
import random
from dataclasses import replace
from typing import cast

import pytest

import tachk
from tachk.analysis.failures import can_fail
from tachk.analysis.fold import known_values
from tachk.base.span import Source
from tachk.engine.compiler.codegen import CodeGenerator
from tachk.engine.compiler.lower import lower
from tachk.engine.compiler.program import Program
from tachk.engine.compiler.slot_layout import SlotLayout
from tachk.formats.loading.load import load_model
from tachk.model.evaluate import Environment, evaluate
from tachk.model.expressions import Assign, Call, Constant, Function
from tachk.model.fault import EvaluationFault, RuntimeErrorKind
from tachk.model.floating import FloatingOperation, halves, number_of
from tachk.model.network import Network
from tachk.model.variable_layout import variable_layout
from tests.support.machine import Machine, initial_slots
from tests.support.seeds import enough, seeds

NUMBERS = [
    *(0.0, -0.0, 0.5, -0.5, 1.5, 2.5, -2.5, 0.1, 1 / 3, 0.49999999999999994, -0.49999999999999994, 4503599627370495.5),
    *(4503599627370497.0, 9007199254740993.0, 2147483647.0, 2147483647.5, 2147483648.0, -2147483648.0, -2147483649.0),
    *(5e-324, 2.2250738585072014e-308, 1.7976931348623157e308, -1.7976931348623157e308, 1e300, math.pi),
]
LIBRARY = ctypes.CDLL(None)
FUNCTIONS = {
    FloatingOperation.ABSOLUTE: "fabs",
    FloatingOperation.SQUARE_ROOT: "sqrt",
    FloatingOperation.FLOOR: "floor",
    FloatingOperation.CEILING: "ceil",
    FloatingOperation.TRUNCATE: "trunc",
    FloatingOperation.ROUND: "round",
}


def c_function(name: str, number: float) -> float | None:
    function = getattr(LIBRARY, name)
    function.restype, function.argtypes = ctypes.c_double, [ctypes.c_double]
    result = cast("float", function(number))
    return result if math.isfinite(result) else None


@pytest.mark.parametrize("operation", FUNCTIONS, ids=lambda operation: operation.name)
def test_functions_are_those_of_the_library_of_c(operation: FloatingOperation) -> None:
    for number in NUMBERS:
        found, expected = operation.compute((number,)), c_function(FUNCTIONS[operation], number)
        assert found == expected, number
        if expected is not None and found is not None:
            assert math.copysign(1, found) == math.copysign(1, expected), number


def test_a_number_is_its_two_halves() -> None:
    for number in NUMBERS:
        assert math.copysign(1, number_of(halves(number))) == math.copysign(1, number)
        assert number_of(halves(number)) == number
    assert halves(1.0) == (0x3FF00000, 0)


@pytest.mark.parametrize(
    ("operation", "arguments", "result"),
    [
        (FloatingOperation.ADD, (0.1, 0.2), 0.30000000000000004),
        (FloatingOperation.ADD, (1.7e308, 1.7e308), None),
        (FloatingOperation.DIVIDE, (1.0, 0.0), None),
        (FloatingOperation.DIVIDE, (0.0, -0.0), None),
        (FloatingOperation.DIVIDE, (1.0, 5e-324), None),
        (FloatingOperation.MULTIPLY, (1e200, 1e200), None),
        (FloatingOperation.SQUARE_ROOT, (-1.0,), None),
        (FloatingOperation.TO_INTEGER, (-2147483648.9,), -(2**31)),
        (FloatingOperation.TO_INTEGER, (2147483648.0,), None),
        (FloatingOperation.TO_INTEGER, (-0.9,), 0),
        (FloatingOperation.EQUAL, (0.0, -0.0), 1),
    ],
)
def test_what_is_not_finite_is_no_result(
    operation: FloatingOperation, arguments: tuple[float, ...], result: float | None
) -> None:
    assert operation.compute(arguments) == result


# ---- random functions -----------------------------------------------------------------------------------------------

LIMIT = 2
PAIRS = list(itertools.product(range(-LIMIT, LIMIT + 1), repeat=2))


class Writer:
    """Writes the body of `int f(int n, int m)` with doubles x, y, z[3] and a function `double g(double a, int k)`."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)

    def text(self) -> str:
        body = " ".join(self.statement(2) for _ in range(self.random.randint(2, 5)))
        return (
            "const double C[2] = { 0.75, -1.5 };\n"
            "double count = 0.0;\n"
            f"double g(double a, int k) {{ double b = k; a -= b / 2; if ({self.simple()}) return b; return a; }}\n"
            "void move(double &to, double from) { to = from; }\n"
            "int f(int n, int m) { double x = n, y = m * 0.1; double z[3] = { 0.5, n, -2.25 };\n"
            f"    {body} return fint(x + z[0]) + ({self.truth(2)} ? 1 : 0); }}\n"
        )

    def simple(self) -> str:
        return self.random.choice(["a > b", "a == b", "!(a <= 1)", "a != b && k > 0"])

    def whole(self) -> str:
        return self.random.choice(["n", "m", "n * m", "1", "n % 2", "3"])

    def place(self) -> str:
        return self.random.choice(["x", "x", "y", "z[0]", "z[1]", "z[n > m ? 1 : 2]"])

    def truth(self, depth: int) -> str:
        operator = self.random.choice(["<", "<=", "==", "!=", ">", ">="])
        return f"{self.number(depth)} {operator} {self.number(depth)}"

    def number(self, depth: int) -> str:
        leaf = self.random.choice(
            [self.place(), self.place(), "C[1]", "C[0]", "0.1", "1e3", "M_PI", f"({self.whole()})"]
        )
        if depth <= 0:
            return leaf
        inner = [self.number(depth - 1) for _ in range(2)]
        return self.random.choice(
            [
                leaf,
                *(f"({inner[0]} {operator} {inner[1]})" for operator in ("+", "-", "*", "/", "<?", ">?")),
                *(f"{name}({inner[0]})" for name in ("fabs", "sqrt", "floor", "ceil", "trunc", "round", "-")),
                *(f"{name}({inner[0]}, {inner[1]})" for name in ("fmin", "fmax")),
                f"g({inner[0]}, {self.whole()})",
                f"(x = {inner[0]})",
                f"(({self.truth(0)}) ? {inner[0]} : {inner[1]})",
                f"fint(fmin(fmax({inner[0]}, -1000), 1000))",
            ]
        )

    def statement(self, depth: int) -> str:
        kinds = ["assign", "assign", "compound", "reference", "global"] + (["if", "loop"] if depth > 0 else [])
        match self.random.choice(kinds):
            case "compound":
                return f"{self.place()} {self.random.choice('+-*/')}= {self.number(1)};"
            case "reference":
                return f"move({self.place()}, {self.number(1)});"
            case "global":
                return "count = x;"
            case "if":
                return f"if ({self.truth(1)}) {{ {self.statement(depth - 1)} }} else {{ {self.statement(depth - 1)} }}"
            case "loop":
                return f"for (i : int[0,2]) {{ {self.statement(depth - 1)} }}"
            case _:
                return f"{self.place()} = {self.number(2)};"


def model(functions: str, checks: str) -> str:
    return (
        f"{functions}int N, M, out;\nbool done;\n"
        f"process P() {{ init location a {{ to b {{ select n : int[-{LIMIT},{LIMIT}], m : int[-{LIMIT},{LIMIT}]; "
        f"{checks}assign N = n, M = m, out = f(n, m) % 1000, done = true; }} }} location b; }}\nsystem P;\n"
    )


def function_of(network: Network) -> Function:
    updates = network.processes[0].edges[0].updates
    calls = (node.value for node in updates if isinstance(node, Assign))
    return next(call.left.function for call in calls if hasattr(call, "left") and isinstance(call.left, Call))


def evaluated(network: Network, base: Program, function: Function, pair: tuple[int, int]) -> int | RuntimeErrorKind:
    layout = variable_layout(network)
    call = Call(function, tuple(map(Constant, pair)), function.result)
    try:
        expected: int | RuntimeErrorKind = evaluate(call, Environment(layout, list(layout.initial)))
    except EvaluationFault as fault:
        expected = fault.kind
        assert can_fail(call, known_values(network, []))
    known = known_values(network, [])
    slots = SlotLayout(network, known)
    generator = CodeGenerator(slots, known)
    start = generator.value_code(call)
    generator.finish()
    code, sites = tuple(generator.assembler.code), tuple(generator.assembler.sites)
    program = replace(base, slots=tuple(slots.slots), code=code, sites=sites)
    found: int | RuntimeErrorKind | None
    try:
        found = Machine(program, initial_slots(program)).run(start)
    except EvaluationFault as fault:
        found = fault.kind
    assert found == expected
    return expected


@pytest.mark.parametrize("seed", seeds(range(25)))
def test_random_functions(seed: int) -> None:
    functions = Writer(seed).text()
    network = load_model(Source("m.ta", model(functions, ""))).network
    function = function_of(network)
    base, _ = lower(network)
    results = {pair: evaluated(network, base, function, pair) for pair in PAIRS}
    fine = {pair: value for pair, value in results.items() if isinstance(value, int)}
    size = 2 * LIMIT + 1
    tables = "".join(
        f"const int {name}[{size}][{size}] = {{ "
        + ", ".join(
            "{ " + ", ".join(str(cell((n, m))) for m in range(-LIMIT, LIMIT + 1)) + " }"
            for n in range(-LIMIT, LIMIT + 1)
        )
        + " };\n"
        for name, cell in (
            ("FINE", lambda pair: int(pair in fine)),
            ("RESULT", lambda pair: math.fmod(fine.get(pair, 0), 1000).__trunc__()),
        )
    )
    at = f"[n + {LIMIT}][m + {LIMIT}]"
    guarded = tachk.loads(model(functions + tables, f"guard FINE{at} == 1; "))
    query = f"A[] done imply out == RESULT[N + {LIMIT}][M + {LIMIT}]"
    assert guarded.verify(query)[0].answer is tachk.Answer.HOLDS
    wrong = next((pair for pair in PAIRS if pair not in fine), None)
    if wrong is not None:
        n, m = wrong
        alone = tachk.loads(model(functions, f"guard n == {n} && m == {m}; "))
        verdict = alone.verify("A[] !done")[0]
        assert verdict.answer is tachk.Answer.UNKNOWN
        assert verdict.fault is not None and verdict.fault.kind is results[wrong]


def test_some_functions_go_wrong_and_most_do_not() -> None:
    """The random functions are worth something."""
    outcomes = []
    for seed in seeds(range(12)):
        network = load_model(Source("m.ta", model(Writer(seed).text(), ""))).network
        function = function_of(network)
        base, _ = lower(network)
        outcomes += [isinstance(evaluated(network, base, function, pair), int) for pair in PAIRS[::3]]
    assert enough(0.3 < sum(outcomes) / len(outcomes) < 0.98)


@pytest.mark.parametrize(
    ("name", "function"),
    [("round", "round"), ("floor", "floor"), ("ceil", "ceil"), ("trunc", "trunc"), ("fabs", "fabs")],
)
def test_the_core_computes_what_the_library_of_c_does(name: str, function: str) -> None:
    """Also of halves, which random numbers seldom are."""
    halves_of = [n / 2 for n in range(-7, 8)]
    expected = [int(c_function(function, number) or 0) for number in halves_of]
    table = ", ".join(map(str, expected))
    found = tachk.loads(
        f"const int EXPECTED[15] = {{ {table} }}; int n = -7;\n"
        f"int f(int k) {{ double d = k; d /= 2; return fint({name}(d)); }}\n"
        "process P() { init location s { to s { guard n < 7; assign n++; } } } system P;"
    ).verify("A[] f(n) == EXPECTED[n + 7]")
    assert found[0].answer is tachk.Answer.HOLDS
