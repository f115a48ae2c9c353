"""Explanations of what is reported about types and about comparisons of clocks."""

from __future__ import annotations

from tachk.base.diagnostics.explanation import Explanation


def _guarded(guard: str) -> str:
    return f"process P() {{ clock x, y; bool b; state s; init s;\n    trans s -> s {{ guard {guard}; }}; }}"


TYPE_CODES: dict[str, Explanation] = {
    "E0301": Explanation(
        "integer expected",
        "Arithmetic works on integers and booleans. Clocks can be added and subtracted only inside a comparison, "
        "scalars, arrays and structs not at all.",
        "int a[2];\nint f() { return a + 1; }",
        "int a[2];\nint f() { return a[0] + 1; }",
    ),
    "E0302": Explanation(
        "cannot be assigned",
        "Integers and booleans can be assigned to each other (a non-zero integer is true), scalars to the same scalar "
        "type, arrays and structs to others of the same shape, and integers to clocks.",
        "int a[2], b[3];\nvoid f() { a = b; }",
        "int a[2], b[2];\nvoid f() { a = b; }",
    ),
    "E0303": Explanation(
        "not a variable",
        "Constants, bound variables and computed values cannot be changed.",
        "const int n = 1;\nvoid f() { n = 2; }",
        "int n = 1;\nvoid f() { n = 2; }",
    ),
    "E0304": Explanation(
        "different types",
        "The two sides of a comparison, or of ?:, must have types that go together.",
        "struct { int a; } r;\nbool f() { return r == 1; }",
        "struct { int a; } r;\nbool f() { return r.a == 1; }",
    ),
    "E0305": Explanation(
        "not a condition",
        "A condition is an integer or boolean expression, or a comparison of clocks; a clock by itself is neither.",
        _guarded("x"),
        _guarded("x > 0"),
    ),
    "E0306": Explanation(
        "not an array, or a wrong index",
        "Only arrays can be indexed, by integers; an array whose size is a scalar type only by values of that type.",
        "int n;\nint f() { return n[0]; }",
        "int n[2];\nint f() { return n[0]; }",
    ),
    "E0307": Explanation(
        "not a struct",
        "Only structs have fields.",
        "int n;\nint f() { return n.size; }",
        "struct { int size; } n;\nint f() { return n.size; }",
    ),
    "E0308": Explanation(
        "wrong number of arguments",
        "A call has one argument for each parameter.",
        "int twice(int a) { return 2 * a; }\nint f() { return twice(); }",
        "int twice(int a) { return 2 * a; }\nint f() { return twice(3); }",
    ),
    "E0309": Explanation(
        "argument of a wrong type",
        "The type of the argument does not go with the type of the parameter.",
        "int first(int a[2]) { return a[0]; }\nint f() { return first(3); }",
        "int b[2];\nint first(int a[2]) { return a[0]; }\nint f() { return first(b); }",
    ),
    "E0310": Explanation(
        "recursion",
        "Functions cannot call themselves, directly or through others: a state has no stack.",
        "int f(int n) { return n == 0 ? 1 : n * f(n - 1); }",
        "int f(int n) { int p = 1; while (n > 0) { p *= n; n--; } return p; }",
    ),
    "E0311": Explanation(
        "missing return",
        "Control can reach the end of a function that has to return a value.",
        "int sign(int n) { if (n < 0) return -1; }",
        "int sign(int n) { if (n < 0) return -1; return 1; }",
    ),
    "E0312": Explanation(
        "wrong result",
        "What a return statement returns must have the result type of the function.",
        "void f() { return 1; }",
        "int f() { return 1; }",
    ),
    "E0313": Explanation(
        "side effect",
        "Guards, invariants, rates, channel indices, queries and signals are evaluated any number of times, so they "
        "must not change variables or clocks, nor call functions that do.",
        "int n;\nprocess P() { state s; init s; trans s -> s { guard n++ < 3; }; }",
        "int n;\nprocess P() { state s; init s; trans s -> s { guard n < 3; assign n++; }; }",
    ),
    "E0315": Explanation(
        "type that cannot stand here",
        "Clocks and channels are passed by reference, never by value, but for a clock of a template that begins with a "
        "number, `P(2)`; they cannot be constants, results or local to a function. Only channels are urgent or "
        "broadcast. A channel cannot be a field.",
        "void f(clock c) { c = 0; }",
        "void f(clock &c) { c = 0; }",
    ),
    "E0316": Explanation(
        "bounded type expected",
        "Select, quantifiers, iterations and free parameters run over all values of a type, so it needs bounds.",
        "bool f() { return forall (i : int) i < 3; }",
        "bool f() { return forall (i : int[0,2]) i < 3; }",
    ),
    "E0317": Explanation(
        "reference needs a variable",
        "A parameter with & stands for the variable itself, so its argument must be one.",
        "void set(int &a) { a = 1; }\nvoid f() { set(2 + 3); }",
        "int n;\nvoid set(int &a) { a = 1; }\nvoid f() { set(n); }",
    ),
    "E0318": Explanation(
        "wrong initial value",
        "An array needs a value for each element, a struct for each field, each once. Channels have no value.",
        "int a[3] = {1, 2};",
        "int a[3] = {1, 2, 3};",
    ),
    "E0330": Explanation(
        "clocks compared in a wrong place",
        "Clocks are compared in guards, invariants and queries. An update that depends on a clock is two edges with "
        "different guards.",
        "process P() { clock x; bool b; state s; init s; trans s -> s { assign b = x < 3; }; }",
        "process P() { clock x; bool b; state s; init s;\n"
        "    trans s -> s { guard x < 3; assign b = true; }, s -> s { guard x >= 3; assign b = false; }; }",
    ),
    "E0331": Explanation(
        "condition that is not convex",
        "A guard or invariant must describe a convex set of clock values: comparisons joined by &&, and disjunctions "
        "of which at most one side compares clocks. `b || x <= 5` is fine, `x <= 5 || y <= 5` has to be two edges.",
        _guarded("x <= 5 || y <= 5"),
        "process P() { clock x, y; bool b; state s; init s;\n"
        "    trans s -> s { guard x <= 5; }, s -> s { guard y <= 5; }; }",
    ),
    "E0332": Explanation(
        "clocks compared with !=",
        "The values different from a constant are not a convex set. Write two edges, one with < and one with >.",
        _guarded("x != 5"),
        _guarded("x > 5"),
    ),
    "E0333": Explanation(
        "clocks compared in a function",
        "A function computes with integers; it may reset a clock that is passed by reference, but not look at it.",
        "bool late(clock &c) { return c > 5; }",
        "void restart(clock &c) { c = 0; }",
    ),
    "E0334": Explanation(
        "rate",
        "A conjunct `x' == e` of an invariant lets the clock x stand still where e is 0 and run where e is 1. Rates "
        "cannot stand anywhere else.",
        "process P() { int x; state s { x' == 0 }; init s; }",
        "process P() { clock x; state s { x' == 0 }; init s; }",
    ),
    "E0335": Explanation(
        "comparison of too many clocks",
        "Zones relate two clocks at a time: `x ~ e` and `x - y ~ e` with an integer expression e.",
        _guarded("x + y < 5"),
        _guarded("x - y < 5"),
    ),
}
