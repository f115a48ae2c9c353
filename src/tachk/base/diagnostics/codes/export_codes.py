"""Explanations of what reading and writing the formats of other tools reports."""

from __future__ import annotations

from tachk.base.diagnostics.explanation import Explanation

EXPORT_CODES: dict[str, Explanation] = {
    "E0820": Explanation(
        "not readable as TChecker's format",
        "A .tck file has one declaration on each line: a word, its arguments between colons, and attributes in braces. "
        "The first is `system:NAME`.",
        "clock:x",
        "clock:1:x",
    ),
    "E0821": Explanation(
        "vector of events without a counterpart",
        "Two events become a channel from the first process to the second; one event followed by weak ones (`P@e?`) "
        "becomes a broadcast channel, and three or more events that all must happen are one as well. A vector of weak "
        "events alone, or of several events of which only some are weak, is not a synchronisation over channels.",
        "sync:P@a?:Q@a?:R@a?",
        "sync:P@a:Q@a?:R@a?",
    ),
    "W0130": Explanation(
        "attribute that is not read",
        "Locations have the attributes initial, urgent, committed, invariant and labels, edges provided and do. "
        "Like TChecker, tachk ignores others.",
    ),
    "E0801": Explanation(
        "no expansion into UPPAAL's language",
        "Everything that tachk adds to UPPAAL's language is written out for UPPAAL in one fixed way (see "
        "docs/uppaal.md). This is not possible for values on channels that are declared inside a template, or values "
        "of types without a name.",
        "process P() { chan c; init location A { to A { sync c!1; } } }",
        "chan c; process P() { init location A { to A { sync c!1; } } }",
    ),
    "E0802": Explanation(
        "TChecker cannot say this",
        "TChecker has no urgent channels, no priorities, no clocks that stand still, no functions, no comparison of "
        "two clocks, no guards on edges that receive a broadcast, and arrays with one initial value for all elements. "
        "If a model uses any of these, tachk does not write it, and lists all places.",
    ),
    "E0803": Explanation(
        "Munta cannot say this",
        "Munta has no priorities, no clocks that stand still or are set to another value than 0, no comparison of two "
        "clocks, no invariants that depend on variables, no clock guards on edges that receive a broadcast, no urgent "
        "channels, and no queries about whole runs that mean what they mean here. What an edge reads must have few "
        "enough values to be told one by one.",
    ),
    "E0810": Explanation(
        "addition of tachk",
        "The text uses something that UPPAAL does not know. Write the model with `tachk export`, which expands it.",
        "process P() { init location A; }",
        "process P() { state A; init A; }",
    ),
    "E0811": Explanation(
        "name that UPPAAL refuses",
        "UPPAAL reserves words that older versions and tachk do not, and version 5 declares types and constants before "
        "the model begins. `tachk convert --fix` renames them everywhere.",
        "process P() { state exit; init exit; }",
        "process P() { state exit_1; init exit_1; }",
    ),
    "E0812": Explanation(
        "name that only newer versions declare",
        "int8_t, INT16_MAX and their like are declared by UPPAAL 5. `tachk export` writes the ranges and numbers.",
        "int8_t n;",
        "int[-128, 127] n;",
    ),
    "E0813": Explanation(
        "construct of newer versions",
        "This came into UPPAAL's language after the version that was asked for.",
        "const bool a = true xor false;",
        "const bool a = true != false;",
    ),
    "E0814": Explanation(
        "order of words in a type",
        "UPPAAL reads `urgent broadcast chan`, in this order, and one prefix for any other type.",
        "broadcast urgent chan c;",
        "urgent broadcast chan c;",
    ),
    "E0815": Explanation(
        "query that UPPAAL refuses",
        "UPPAAL takes `deadlock` in E<> and A[] only, and not at all in models with priorities or in which a receiver "
        "of a broadcast has a clock in its guard. tachk checks these.",
    ),
    "E0816": Explanation(
        "type name used for something else",
        "Where UPPAAL reads the name of a location, a template, a parameter or a process, the name of a visible type "
        "is a syntax error.",
        "typedef int[0,3] slot; process P() { state slot; init slot; }",
        "typedef int[0,3] slot_t; process P() { state slot; init slot; }",
    ),
    "E0817": Explanation(
        "parameter where UPPAAL wants a known value",
        "UPPAAL takes a parameter for a value that is known when it reads the model only if it is `const` and passed "
        "by value. Initial values, ranges, sizes of arrays and arguments of an instantiation need such values.",
        "process P(int[0,3] i) { int k = i; state s; init s; }",
        "process P(const int[0,3] i) { int k = i; state s; init s; }",
    ),
    "E0818": Explanation(
        "clock that equals something in an invariant",
        "UPPAAL wants invariants to bound clocks from above. An equality does more: it also keeps processes from "
        "entering the location early. tachk gives it this meaning.",
        "process P() { clock x; state s { x == 0 }; init s; }",
        "process P() { clock x; state s { x <= 0 }; init s; }",
    ),
    "E0819": Explanation(
        "name of a location that UPPAAL refuses",
        "In an XML file two locations of a template have the same name, or a name is not an identifier. tachk reads it "
        "under another name and says so (W0121); UPPAAL refuses the file.",
    ),
    "E0822": Explanation(
        "below the system line",
        "UPPAAL reads declarations, templates and instantiations, then the system line, then `progress`, then `gantt`. "
        "`tachk export` writes the model in this order.",
        "process P() { state A; init A; } system P; const int N = 3;",
        "const int N = 3; process P() { state A; init A; } system P;",
    ),
    "E0823": Explanation(
        "condition about clocks that UPPAAL does not take",
        "In guards and invariants UPPAAL takes comparisons of clocks joined by `&&`; an `||` or `imply` may have "
        "clocks on one side, not left of `imply`. It takes no `!`, `?:` or `exists` over them, and in queries no "
        "`?:` and no `==` of two conditions. tachk does; `tachk export` writes them with `&&`, `||` and `forall`.",
        "process P() { clock x; state A; init A; trans A -> A { guard !(x <= 5); }; }",
        "process P() { clock x; state A; init A; trans A -> A { guard x > 5; }; }",
    ),
    "W0501": Explanation(
        "UPPAAL treats this otherwise",
        "The model loads, but UPPAAL warns about it, gives it another meaning, or answers less precisely.",
    ),
}
