"""What a formula says, as `tachk explain` prints it."""

from __future__ import annotations

from fractions import Fraction
from math import lcm

from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.time_units import unit_in_text
from tachk.logic.durations import resolve, scaled
from tachk.logic.fragment import outside_fragment
from tachk.logic.horizon import horizon
from tachk.logic.observer.construction import NoObserver, build_observer
from tachk.logic.simplify import simplify
from tachk.recordings.monitors.formulas import NamedFormula
from tachk.recordings.monitors.given_constants import constants_by_name
from tachk.syntax.ast import BuiltinType, VariableDeclaration
from tachk.syntax.formula import Duration, Formula
from tachk.syntax.formulas.printer import print_formula, print_number
from tachk.syntax.walk import nodes_of_kind

_INSTANTS = "instants    what is true for no time only, such as in a committed location of a model, does not count"


def formula_lines(named: NamedFormula) -> list[str]:
    """The formula in canonical form, how far it looks ahead, and the automaton that observes it."""
    lines = [f"sentence    {named.sentence}"] if named.sentence else []
    lines.append(f"formula     {named.text}")
    named = named.within(())
    formula = named.formula
    if (simpler := simplify(formula)) != formula:
        lines.append(f"simpler     {print_formula(simpler)}")
    try:
        formula, unit = _resolved(named)
        lines.append(f"look-ahead  {_horizon(formula, unit)}")
    except InputError as error:
        lines.append(f"look-ahead  not known: {error.diagnostics[0].message}")
    lines.append(_INSTANTS)
    offence = outside_fragment(formula)
    if offence is None:
        lines.append("fragment    STL with lb = 0: every interval begins at 0, and only an outermost G has no end")
    else:
        lines.append(f"fragment    not STL with lb = 0, because of {print_formula(offence.formula)}: {offence.reason}")
    if all(isinstance(duration.value, Fraction) for duration in nodes_of_kind(formula, Duration)):
        lines.append(f"observer    {_observer(formula)}")
    return lines


def _observer(formula: Formula) -> str:
    """The size of the observer automaton of the formula. It does not depend on the unit of time, which is taken small
    enough for all bounds."""
    values = [duration.value for duration in nodes_of_kind(formula, Duration) if isinstance(duration.value, Fraction)]
    scale = lcm(*(value.denominator for value in values))
    try:
        template = build_observer(scaled(formula, Fraction(scale)), "Observer").template
    except NoObserver as reason:
        return f"none: {reason.reason}"
    names = ", ".join(location.name.name for location in template.locations)
    clocks = sum(
        len(declaration.declarators)
        for declaration in template.declarations
        if isinstance(declaration, VariableDeclaration)
        and declaration.type is not None
        and declaration.type.base == BuiltinType(declaration.span, "clock")
    )
    return f"{len(template.locations)} locations ({names}), {clocks} {'clock' if clocks == 1 else 'clocks'}"


def _resolved(named: NamedFormula) -> tuple[Formula, str]:
    """The formula with numbers as bounds, and their unit, empty where it is not known."""
    unit = named.unit
    if not unit:
        given = {bound.unit for bound in nodes_of_kind(named.formula, Duration) if bound.value != 0}
        unit = next(iter(given)) if len(given) == 1 else "s" if "" not in given or named.durations else ""
    formula = resolve(named.formula, constants_by_name(named.numbers(unit or "s" if named.durations else unit)), unit)
    return formula, unit


def _horizon(formula: Formula, unit: str) -> str:
    reach = horizon(formula)
    if reach is None:
        return "unlimited: the verdict can stay open as long as the run goes on"
    return f"{_time(reach, unit)}: the verdict is known after it" if reach else "none: the verdict is known at once"


def _time(reach: Fraction, unit: str) -> str:
    factor, name = unit_in_text(unit)
    if not name:
        return f"{print_number(reach)} time unit{'' if reach == 1 else 's'}"
    return f"{print_number(reach * factor)} {name}"
