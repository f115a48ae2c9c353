"""The interface for plug-ins beside `tachk` itself: the parts of networks and their meaning; `tachk.api.proofs` has
proofs about them.

A plug-in is a distribution of its own, such as ``plugins/munta``. Other modules may move without notice.
"""

from __future__ import annotations

from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.job import current_job, unhurried
from tachk.base.operators import BinaryOperator, UnaryOperator
from tachk.base.span import Span
from tachk.base.whole_files import write_whole
from tachk.base.words import Direction, QueryKind
from tachk.meaning.constraints import Conjunction, Disjunction, conditional_constraints, disjunctive
from tachk.meaning.dbm import INFINITY, LESS_EQUAL_ZERO, bound_value, is_strict
from tachk.meaning.discrete import PreparedNetwork, bind_selects, channel_named, prepare
from tachk.model.connectives import both, conjuncts
from tachk.model.evaluate import Environment, evaluate, execute
from tachk.model.expressions import (
    BOOL,
    Binary,
    Constant,
    Deadlock,
    Expression,
    Field,
    Index,
    Quantifier,
    QuantifierKind,
    Reference,
    Unary,
    Variable,
)
from tachk.model.fault import EvaluationFault
from tachk.model.network import Edge, Location, Network
from tachk.model.quantity import bytes_
from tachk.model.query import Query
from tachk.model.run import Participant
from tachk.model.traversal import depends_on_clocks, process_expressions, walk, written_variables
from tachk.model.types import ArrayType, ChannelType, RecordType, ScalarLike, Type, bounds, slot_count
from tachk.model.variable_layout import VariableLayout, begun_clocks

__all__ = [
    "BOOL",
    "INFINITY",
    "LESS_EQUAL_ZERO",
    "ArrayType",
    "Binary",
    "BinaryOperator",
    "ChannelType",
    "Conjunction",
    "Constant",
    "Deadlock",
    "Diagnostic",
    "Direction",
    "Disjunction",
    "Edge",
    "Environment",
    "EvaluationFault",
    "Expression",
    "Field",
    "Index",
    "Location",
    "Network",
    "Participant",
    "PreparedNetwork",
    "Quantifier",
    "QuantifierKind",
    "Query",
    "QueryKind",
    "RecordType",
    "Reference",
    "ScalarLike",
    "Span",
    "Type",
    "Unary",
    "UnaryOperator",
    "UnsupportedError",
    "Variable",
    "VariableLayout",
    "begun_clocks",
    "bind_selects",
    "both",
    "bound_value",
    "bounds",
    "bytes_",
    "channel_named",
    "conditional_constraints",
    "conjuncts",
    "current_job",
    "depends_on_clocks",
    "disjunctive",
    "evaluate",
    "execute",
    "is_strict",
    "prepare",
    "process_expressions",
    "slot_count",
    "unhurried",
    "walk",
    "write_whole",
    "written_variables",
]
