"""Explanations of what is reported about names and constants."""

from __future__ import annotations

from tachk.base.diagnostics.explanation import Explanation

NAME_CODES: dict[str, Explanation] = {
    "E0201": Explanation(
        "unknown name",
        "Nothing of this name is declared here or further out. Globals must be declared above their use; a template "
        "sees the globals, its parameters and its own declarations, never the inside of another process.",
        "int level;\nint twice() { return 2 * levle; }",
        "int level;\nint twice() { return 2 * level; }",
    ),
    "E0202": Explanation(
        "declared twice",
        "One level has one meaning for each name: the globals with the templates and processes, the local declarations "
        "of a template with its locations, the fields of a struct, the properties. An inner level may hide a name of "
        "an outer one.",
        "int level;\nclock level;",
        "int level;\nclock since;",
    ),
    "E0203": Explanation(
        "not a value",
        "The name is declared, but as something else: a type, a function without its parentheses, a template, a "
        "location. What a guard must know about another process has to be in a shared variable.",
        "int zero() { return 0; }\nint one() { return zero + 1; }",
        "int zero() { return 0; }\nint one() { return zero() + 1; }",
    ),
    "E0204": Explanation(
        "unknown type",
        "Types are int, bool, clock, chan, ranges int[a,b], scalar[n], structs and what a typedef above names.",
        "typedef int[0,3] id_t;\nid_y a;",
        "typedef int[0,3] id_t;\nid_t a;",
    ),
    "E0205": Explanation(
        "unknown field",
        "The struct has no field of this name.",
        "struct { int low, high; } range;\nint f() { return range.hihg; }",
        "struct { int low, high; } range;\nint f() { return range.high; }",
    ),
    "E0206": Explanation(
        "unknown process or template",
        "The system line, an instantiation or a query names a process that does not exist. The instances of a template "
        "with free parameters are named with the values of the parameters: T(0), T(1).",
        "process P() { state s; init s; }\nsystem Q;",
        "process P() { state s; init s; }\nsystem P;",
    ),
    "E0207": Explanation(
        "unknown location or local variable",
        "A query, signal or property may name the locations, variables, functions and parameters of a process, and "
        "this process has none of that name.",
        "process P() { state idle; init idle; }\nsystem P;\nproperty rest : A[] P.ilde;",
        "process P() { state idle; init idle; }\nsystem P;\nproperty rest : A[] P.idle;",
    ),
    "E0208": Explanation(
        "not a function",
        "Only functions can be called.",
        "int level;\nint f() { return level(1); }",
        "int level(int i) { return i; }\nint f() { return level(1); }",
    ),
    "E0209": Explanation(
        "unknown location",
        "An edge begins or ends at a location or branchpoint that its template does not have.",
        "process P() { state s; init s; trans s -> t { }; }",
        "process P() { state s, t; init s; trans s -> t { }; }",
    ),
    "E0601": Explanation(
        "not a constant",
        "Sizes, bounds, initial values and arguments passed by value are computed before the model runs, so they can "
        "use constants and functions of constants only.",
        "int n = 3;\nint a[n];",
        "const int n = 3;\nint a[n];",
    ),
    "E0602": Explanation(
        "constant cannot be computed",
        "The computation of a constant divides by zero, leaves 32 bits, uses an index outside its array, or "
        "does not end.",
        "const int zero = 0;\nconst int n = 3 / zero;",
        "const int one = 1;\nconst int n = 3 / one;",
    ),
    "E0603": Explanation(
        "value outside its range",
        "An initial value or argument is outside the range of its type. A plain int holds -32768 to 32767; constants "
        "may use 32 bits.",
        "int[0,3] level = 7;",
        "int[0,7] level = 7;",
    ),
    "E0604": Explanation(
        "empty range",
        "A range, an array or a scalar set must have at least one value.",
        "int[3,1] level;",
        "int[1,3] level;",
    ),
    "E0605": Explanation(
        "integer too large",
        "Integers have 32 bits.",
        "const int n = 2147483648;",
        "const int n = 2147483647;",
    ),
    "E0606": Explanation(
        "variables too large",
        "An array or struct of more than 2**20 values is taken for a mistake: every state would hold a copy of it. All "
        "variables of a model together have at most 2**22 values, a model has at most 50,000 clocks, and arrays and "
        "structs are nested at most 50 levels deep.",
        "int a[2000][2000];",
        "int a[20][20];",
    ),
    "E0607": Explanation(
        "constant without a value",
        "A constant gets its value where it is declared.",
        "const int n;",
        "const int n = 4;",
    ),
    "E0608": Explanation(
        "constant that cannot be set from outside",
        "-D and keyword arguments of load() set boolean and integer constants. Arrays and structs of constants can be "
        "computed from such constants in the model.",
    ),
    "E0609": Explanation(
        "quantifier with too many instances",
        "A quantifier over clock comparisons, rates or processes is written out, one instance for each value. More "
        "than 65536 instances in one model are taken for a mistake.",
        "clock x[2];\nprocess P() { state s; init s;\n"
        "    trans s -> s { guard forall (i : int[0,999999]) x[i % 2] <= 5; }; }",
        "clock x[2];\nprocess P() { state s; init s; trans s -> s { guard forall (i : int[0,1]) x[i] <= 5; }; }",
    ),
}
