"""The standard ``dataclass``, but each method is compiled when it is first called.

The standard decorator compiles six functions for every class while its module is imported. Over some hundred classes,
most of whose methods are never called in one run, that was half of the start of the program. What it does besides takes
several times as long as what is done here, because it knows more kinds of fields than these records have.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

__all__ = ["dataclass"]

if TYPE_CHECKING:
    from dataclasses import dataclass
else:
    import dataclasses
    import types
    from collections.abc import Callable

    _FIELDS = "__dataclass_fields__"
    _MISSING = dataclasses.MISSING

    class _Factory:
        """Stands for the default of a parameter whose value comes from a function."""

        def __repr__(self) -> str:
            return "<factory>"

    _FACTORY = _Factory()

    class _Parameters:
        """The parameters of the decorator, which standard classes need of those they inherit from, and Dask of
        arguments."""

        __slots__ = (
            "eq",
            "frozen",
            "init",
            "kw_only",
            "match_args",
            "order",
            "repr",
            "slots",
            "unsafe_hash",
            "weakref_slot",
        )

        def __init__(self, frozen: bool, slots: bool, eq: bool) -> None:
            self.init = self.repr = self.match_args = True
            self.order = self.unsafe_hash = self.kw_only = self.weakref_slot = False
            self.frozen, self.slots, self.eq = frozen, slots, eq

    def dataclass(*, frozen: bool = False, slots: bool = False, eq: bool = True) -> Callable[[type], type]:
        """`dataclasses.dataclass` with these options; the fields, and what the methods do, are the same.

        There are no `ClassVar`, no `InitVar` and no `KW_ONLY`.
        """

        def decorate(plain: type) -> type:
            fields = _fields(plain)
            made: list[type] = []
            members = {
                _FIELDS: fields,
                "__dataclass_params__": _Parameters(frozen, slots, eq),
                "__match_args__": tuple(each.name for each in fields.values() if each.init and not each.kw_only),
                "__doc__": plain.__doc__ or plain.__name__,
                "__signature__": _Signature(),
            }
            names = ["__init__", "__repr__", *(["__eq__"] if eq else ()), *(["__hash__"] if eq and frozen else ())]
            for name in names:
                if name not in plain.__dict__ or (name == "__hash__" and plain.__hash__ is None):
                    members[name] = _placeholder(plain, made, name, frozen)
            if eq and not frozen and "__hash__" not in plain.__dict__:
                members["__hash__"] = None
            if frozen:
                members |= {"__setattr__": _assign, "__delattr__": _delete}
            if frozen and slots:
                members |= {"__getstate__": _state, "__setstate__": _restore}
            if slots:
                cls = _with_slots(plain, fields, members)
            else:
                cls = plain
                for name, member in members.items():
                    setattr(cls, name, member)
            made.append(cls)
            return cls

        return decorate

    def _fields(plain: type) -> dict[str, dataclasses.Field]:
        """The fields of the classes it inherits from, and its own, whose defaults become attributes of the class."""
        fields = {}
        for base in reversed(plain.__mro__[1:]):
            fields |= base.__dict__.get(_FIELDS, {})
        for name, kind in plain.__annotations__.items():
            given = plain.__dict__.get(name, _MISSING)
            each = given if isinstance(given, dataclasses.Field) else dataclasses.field(default=given)
            each.name, each.type, each._field_type = name, kind, dataclasses._FIELD
            each.kw_only = each.kw_only is True
            if each.default.__class__.__hash__ is None:
                raise ValueError(f"mutable default {each.default!r} for field {name}: use default_factory")
            if each is given and each.default is _MISSING:
                delattr(plain, name)
            elif each is given:
                setattr(plain, name, each.default)
            fields[name] = each
        return fields

    def _with_slots(plain: type, fields: dict[str, dataclasses.Field], more: dict[str, object]) -> type:
        """The same class with slots for its fields and with more members; a class cannot get slots after it was made,
        and what it has from the beginning costs less than what it gets later."""
        there = {slot for base in plain.__mro__[1:-1] for slot in base.__dict__.get("__slots__", ())}
        left_out = {*fields, "__dict__", "__weakref__"}
        members = {name: value for name, value in plain.__dict__.items() if name not in left_out} | more
        members["__slots__"] = tuple(name for name in fields if name not in there)
        cls = type(plain)(plain.__name__, plain.__bases__, members)
        cls.__qualname__ = plain.__qualname__
        return cls

    def _placeholder(plain: type, made: list[type], name: str, frozen: bool) -> Callable[..., object]:
        """A method that puts the real one in its place, in the class that will be made of this one, and calls it."""

        def method(self: object, *arguments: object, **named: object) -> object:
            (cls,) = made
            compiled = _compiled(cls, name, frozen)
            setattr(cls, name, compiled)
            return compiled(self, *arguments, **named)

        method.__name__ = name
        method.__qualname__ = f"{plain.__qualname__}.{name}"
        method.__module__ = plain.__module__
        method.is_placeholder = True
        return method

    def _compiled(cls: type, name: str, frozen: bool) -> Callable[..., object]:
        """One method, as the standard decorator would write it."""
        fields = dataclasses.fields(cls)
        match name:
            case "__init__":
                method = _init(cls, fields, frozen)
            case "__repr__":
                shown = ", ".join(f"{each.name}={{self.{each.name}!r}}" for each in fields if each.repr)
                text = f"def __repr__(self): return f'{{self.__class__.__qualname__}}({shown})'"
                method = _function(_code(text), (), {})
            case "__eq__":
                compared = tuple(each.name for each in fields if each.compare)
                mine, others = (
                    "".join(f"{whose}.{_P}{n}," for n in range(len(compared))) for whose in ("self", "other")
                )
                text = "def __eq__(self, other):\n if other.__class__ is not self.__class__: return NotImplemented"
                method = _function(_code(f"{text}\n return ({mine}) == ({others})"), compared, {})
            case _:
                hashed = tuple(each.name for each in fields if (each.compare if each.hash is None else each.hash))
                values = "".join(f"self.{_P}{n}," for n in range(len(hashed)))
                method = _function(_code(f"def __hash__(self): return hash(({values}))"), hashed, {})
        if name == "__repr__":
            from reprlib import recursive_repr

            method = recursive_repr()(method)
        method.__qualname__ = f"{cls.__qualname__}.{name}"
        method.__module__ = cls.__module__
        return method

    _P = "p_"
    """Begins the names that stand for those of fields in texts, each with a number. So methods of many classes have the
    same text, which is compiled once; compiling took a tenth of the start of the program."""

    _codes: dict[str, types.CodeType] = {}

    def _code(text: str) -> types.CodeType:
        """The code of the function that a text defines."""
        code = _codes.get(text)
        if code is None:
            made: dict[str, types.FunctionType] = {}
            exec(text, made)
            code = _codes[text] = made[text[len("def ") : text.index("(")]].__code__
        return code

    def _function(code: types.CodeType, names: tuple[str, ...], known: dict[str, object]) -> types.FunctionType:
        """The function with the names of fields in their places, and with what is known to it."""
        places = {f"{_P}{number}": name for number, name in enumerate(names)}

        def renamed(things: tuple[object, ...]) -> tuple[object, ...]:
            return tuple(places.get(each, each) if each.__class__ is str else each for each in things)

        code = code.replace(
            co_varnames=renamed(code.co_varnames),
            co_names=renamed(code.co_names),
            co_consts=renamed(code.co_consts),
        )
        return types.FunctionType(code, known, code.co_name)

    def _init(cls: type, fields: tuple[dataclasses.Field, ...], frozen: bool) -> types.FunctionType:
        fields = tuple(sorted(fields, key=lambda each: each.kw_only))
        known: dict[str, object] = {"assign": object.__setattr__, "made": _FACTORY}
        parameters, body = [], []
        defaults, named = [], {}
        for number, each in enumerate(fields):
            name, factory = f"{_P}{number}", f"factory_{number}"
            value = name
            default = each.default
            if each.default_factory is not _MISSING:
                known[factory], default = each.default_factory, _FACTORY
                value = f"{factory}() if {name} is made else {name}" if each.init else f"{factory}()"
            elif not each.init:
                known[f"default_{number}"], value = default, f"default_{number}"
            if each.init:
                if each.kw_only and "*" not in parameters:
                    parameters.append("*")
                parameters.append(name)
                if default is not _MISSING and each.kw_only:
                    named[each.name] = default
                elif default is not _MISSING:
                    defaults.append(default)
                elif defaults and not each.kw_only:
                    raise TypeError(f"non-default argument {each.name!r} follows default argument")
            if each.init or default is not _MISSING:
                body.append(f"assign(self, {name!r}, {value})" if frozen else f"self.{name} = {value}")
        if hasattr(cls, "__post_init__"):
            body.append("self.__post_init__()")
        text = f"def __init__(self, {', '.join(parameters)}):\n " + "\n ".join(body or ["pass"])
        method = _function(_code(text), tuple(each.name for each in fields), known)
        method.__defaults__, method.__kwdefaults__ = tuple(defaults) or None, named or None
        return method

    class _Signature:
        """``__signature__`` of a class whose ``__init__`` may not be compiled yet."""

        def __get__(self, instance: object, owner: type) -> object:
            import inspect

            method = owner.__init__
            if getattr(method, "is_placeholder", False):
                for cls in owner.__mro__:
                    if cls.__dict__.get("__init__") is method:
                        method = _compiled(cls, "__init__", cls.__setattr__ is _assign)
            whole = inspect.signature(method)
            kinds = {each.name: each.type for each in dataclasses.fields(owner)}
            parameters = [
                each.replace(annotation=kinds.get(each.name, each.annotation))
                for each in list(whole.parameters.values())[1:]
            ]
            return whole.replace(parameters=parameters, return_annotation=None)

    def _assign(self: object, name: str, value: object) -> None:
        raise dataclasses.FrozenInstanceError(f"cannot assign to field {name!r}")

    def _delete(self: object, name: str) -> None:
        raise dataclasses.FrozenInstanceError(f"cannot delete field {name!r}")

    def _state(self: object) -> list[object]:
        return [getattr(self, each.name) for each in dataclasses.fields(self)]

    def _restore(self: object, state: list[object]) -> None:
        for each, value in zip(dataclasses.fields(self), state, strict=True):
            object.__setattr__(self, each.name, value)
