"""The standard ``dataclass``, but each method is made when it is first called.

The standard decorator compiles six functions for every class while its module is imported. Over some hundred classes,
most of whose methods are never called in one run, that was half of the start of the program. What it does besides takes
several times as long as what is done here, because it knows more kinds of fields than these records have. And its
module imports parsers of Python, which take longer than half of this package.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

__all__ = ["dataclass", "field", "fields", "is_dataclass", "make_methods", "replace"]

if TYPE_CHECKING:
    from dataclasses import dataclass, field, fields, is_dataclass, replace

    def make_methods(cls: type) -> None: ...

else:
    import types
    from collections.abc import Callable, Iterable, Mapping
    from operator import methodcaller

    from tachk.base import record_methods

    _FIELDS = "__dataclass_fields__"

    class _Missing:
        """Stands for a default that is not given."""

    _MISSING = _Missing()

    class _RecordField:
        """What `dataclasses.Field` says of a field, for the functions of that module too."""

        __slots__ = (
            "_default",
            "_factory",
            "compare",
            "hash",
            "init",
            "kw_only",
            "metadata",
            "name",
            "repr",
            "type",
        )

        @property
        def default(self) -> object:
            return _standard(self._default)

        @property
        def default_factory(self) -> object:
            return _standard(self._factory)

        @property
        def _field_type(self) -> object:
            import dataclasses

            return dataclasses._FIELD

    def _standard(given: object) -> object:
        if given is not _MISSING:
            return given
        import dataclasses

        return dataclasses.MISSING

    def field(
        *,
        default: object = _MISSING,
        default_factory: object = _MISSING,
        init: bool = True,
        repr: bool = True,
        hash: bool | None = None,
        compare: bool = True,
        metadata: Mapping[object, object] | None = None,
        kw_only: bool = False,
    ) -> _RecordField:
        """`dataclasses.field`."""
        made = _RecordField()
        made._default, made._factory = default, default_factory
        made.init, made.repr, made.hash, made.compare, made.kw_only = init, repr, hash, compare, kw_only
        made.metadata = types.MappingProxyType(metadata or {})
        return made

    def is_dataclass(thing: object) -> bool:
        """`dataclasses.is_dataclass`."""
        return hasattr(thing if isinstance(thing, type) else type(thing), _FIELDS)

    def fields(thing: object) -> tuple[_RecordField, ...]:
        """`dataclasses.fields`."""
        if getattr(thing, "__dataclass_params__", None).__class__ is _Parameters:
            return tuple(getattr(thing, _FIELDS).values())
        import dataclasses

        return dataclasses.fields(thing)

    def replace(thing: object, /, **changes: object) -> object:
        """`dataclasses.replace`."""
        cls = thing.__class__
        names = _given_names.get(cls)
        if names is None:
            if getattr(cls, "__dataclass_params__", None).__class__ is not _Parameters:
                import dataclasses

                return dataclasses.replace(thing, **changes)
            names = _given_names[cls] = tuple(each.name for each in getattr(cls, _FIELDS).values() if each.init)
        for name in names:
            if name not in changes:
                changes[name] = getattr(thing, name)
        return cls(**changes)

    _given_names: dict[type, tuple[str, ...]] = {}
    """The names of the arguments of classes of whose objects some were replaced."""

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
            found = _fields(plain)
            made: list[type] = []
            members = {
                _FIELDS: found,
                "__dataclass_params__": _Parameters(frozen, slots, eq),
                "__match_args__": tuple(each.name for each in found.values() if each.init and not each.kw_only),
                "__doc__": plain.__doc__ or plain.__name__,
                "__signature__": _Signature(),
            }
            names = ["__init__", "__repr__", *(["__eq__"] if eq else ()), *(["__hash__"] if eq and frozen else ())]
            for name in names:
                if name not in plain.__dict__ or (name == "__hash__" and plain.__hash__ is None):
                    members[name] = _placeholder(plain, made, name)
            if eq and not frozen and "__hash__" not in plain.__dict__:
                members["__hash__"] = None
            if frozen:
                members |= {"__setattr__": _assign, "__delattr__": _delete}
            if frozen and slots:
                members |= {"__getstate__": _state, "__setstate__": _restore}
            if slots:
                cls = _with_slots(plain, found, members)
            else:
                cls = plain
                for name, member in members.items():
                    setattr(cls, name, member)
            made.append(cls)
            return cls

        return decorate

    def make_methods(cls: type) -> None:
        """Makes the methods of a class now, not when they are first called: for a process of which copies are made."""
        for name, member in [*vars(cls).items()]:
            if getattr(member, "is_placeholder", False):
                setattr(cls, name, _compiled(cls, name))

    def _fields(plain: type) -> dict[str, _RecordField]:
        """The fields of the classes it inherits from, and its own, whose defaults become attributes of the class."""
        found = {}
        for base in reversed(plain.__mro__[1:]):
            found |= base.__dict__.get(_FIELDS, {})
        for name, kind in plain.__annotations__.items():
            given = plain.__dict__.get(name, _MISSING)
            each = given if given.__class__ is _RecordField else field(default=given)
            each.name, each.type = name, kind
            default = each._default
            if default.__class__.__hash__ is None:
                raise ValueError(f"mutable default {default!r} for field {name}: use default_factory")
            if default.__class__.__module__ == "dataclasses":
                raise TypeError(f"field {name}: the function `field` is that of {__name__}")
            if each is given and default is _MISSING:
                delattr(plain, name)
            elif each is given:
                setattr(plain, name, default)
            found[name] = each
        return found

    def _with_slots(plain: type, found: dict[str, _RecordField], more: dict[str, object]) -> type:
        """The same class with slots for its fields and with more members; a class cannot get slots after it was made,
        and what it has from the beginning costs less than what it gets later."""
        there = {slot for base in plain.__mro__[1:-1] for slot in base.__dict__.get("__slots__", ())}
        left_out = {*found, "__dict__", "__weakref__"}
        members = {name: value for name, value in plain.__dict__.items() if name not in left_out} | more
        members["__slots__"] = tuple(name for name in found if name not in there)
        cls = type(plain)(plain.__name__, plain.__bases__, members)
        cls.__qualname__ = plain.__qualname__
        return cls

    def _placeholder(plain: type, made: list[type], name: str) -> Callable[..., object]:
        """A method that puts the real one in its place, in the class that will be made of this one, and calls it."""

        def method(self: object, *arguments: object, **named: object) -> object:
            (cls,) = made
            compiled = _compiled(cls, name)
            setattr(cls, name, compiled)
            return compiled(self, *arguments, **named)

        method.__name__ = name
        method.__qualname__ = f"{plain.__qualname__}.{name}"
        method.__module__ = plain.__module__
        method.is_placeholder = True
        return method

    def _compiled(cls: type, name: str) -> Callable[..., object]:
        """One method, as the standard decorator would write it."""
        all_fields = fields(cls)
        match name:
            case "__init__":
                method = _init(cls, all_fields)
            case "__repr__":
                method = _repr([each.name for each in all_fields if each.repr])
            case "__eq__":
                compared = tuple(each.name for each in all_fields if each.compare)
                method = _function(_code("equal", len(compared)), name, compared, {})
            case _:
                hashed = tuple(each.name for each in all_fields if (each.compare if each.hash is None else each.hash))
                method = _function(_code("hash", len(hashed)), name, hashed, {})
        method.__qualname__ = f"{cls.__qualname__}.{name}"
        method.__module__ = cls.__module__
        return method

    def _repr(shown: Iterable[str]) -> types.FunctionType:
        from reprlib import recursive_repr

        def __repr__(self: object) -> str:  # noqa: N807
            values = ", ".join(f"{name}={getattr(self, name)!r}" for name in shown)
            return f"{self.__class__.__qualname__}({values})"

        return recursive_repr()(__repr__)

    _codes: dict[tuple[str, int], types.CodeType] = {}

    def _code(kind: str, number: int) -> types.CodeType:
        """The code of a method of records with so many fields."""
        code = _codes.get((kind, number))
        if code is None:
            known = record_methods.METHODS[kind]
            made = known[number] if number < len(known) else eval(record_methods.text(kind, number))
            code = _codes[kind, number] = made.__code__
        return code

    def _function(
        code: types.CodeType, method: str, names: tuple[str, ...], known: dict[str, object], named_only: int = 0
    ) -> types.FunctionType:
        """The function with the names of fields in their places, and with what is known to it."""
        places = {f"p_{number}": name for number, name in enumerate(names)}

        def renamed(things: tuple[object, ...]) -> tuple[object, ...]:
            return tuple(places.get(each, each) if each.__class__ is str else each for each in things)

        code = code.replace(
            co_name=method,
            co_varnames=renamed(code.co_varnames),
            co_names=renamed(code.co_names),
            co_consts=renamed(code.co_consts),
            co_argcount=code.co_argcount - named_only,
            co_kwonlyargcount=named_only,
        )
        return types.FunctionType(code, known, method)

    def _init(cls: type, all_fields: tuple[_RecordField, ...]) -> types.FunctionType:
        given = sorted((each for each in all_fields if each.init), key=lambda each: each.kw_only)
        defaults, named = [], {}
        for each in given:
            default = each._default if each._factory is _MISSING else _FACTORY
            if default is not _MISSING and each.kw_only:
                named[each.name] = default
            elif default is not _MISSING:
                defaults.append(default)
            elif defaults and not each.kw_only:
                raise TypeError(f"non-default argument {each.name!r} follows default argument")
        known: dict[str, object] = {"assign": object.__setattr__}
        after = _completion(cls, all_fields)
        if after is not None:
            known["after"] = after
        method = _function(
            _code("init" if after is None else "init and after", len(given)),
            "__init__",
            tuple(each.name for each in given),
            known,
            sum(each.kw_only for each in given),
        )
        method.__defaults__, method.__kwdefaults__ = tuple(defaults) or None, named or None
        return method

    def _completion(cls: type, all_fields: Iterable[_RecordField]) -> Callable[[object], None] | None:
        """What an object needs when its arguments are assigned: other values, and its own ``__post_init__``."""
        made = [(each.name, each.init, each._factory) for each in all_fields if each._factory is not _MISSING]
        left_out = [each for each in all_fields if not each.init]
        constant = [(each.name, each._default) for each in left_out if each._default is not _MISSING]
        begun = hasattr(cls, "__post_init__")
        if not made and not constant:
            return methodcaller("__post_init__") if begun else None
        assign = object.__setattr__

        def complete(self: object) -> None:
            for name, is_given, factory in made:
                if not is_given or getattr(self, name) is _FACTORY:
                    assign(self, name, factory())
            for name, value in constant:
                assign(self, name, value)
            if begun:
                self.__post_init__()

        return complete

    class _Signature:
        """``__signature__`` of a class whose ``__init__`` may not be compiled yet."""

        def __get__(self, instance: object, owner: type) -> object:
            import inspect

            method = owner.__init__
            if getattr(method, "is_placeholder", False):
                for cls in owner.__mro__:
                    if cls.__dict__.get("__init__") is method:
                        method = _compiled(cls, "__init__")
            whole = inspect.signature(method)
            kinds = {each.name: each.type for each in fields(owner)}
            parameters = [
                each.replace(annotation=kinds.get(each.name, each.annotation))
                for each in list(whole.parameters.values())[1:]
            ]
            return whole.replace(parameters=parameters, return_annotation=None)

    def _assign(self: object, name: str, value: object) -> None:
        from dataclasses import FrozenInstanceError

        raise FrozenInstanceError(f"cannot assign to field {name!r}")

    def _delete(self: object, name: str) -> None:
        from dataclasses import FrozenInstanceError

        raise FrozenInstanceError(f"cannot delete field {name!r}")

    def _state(self: object) -> list[object]:
        return [getattr(self, each.name) for each in fields(self)]

    def _restore(self: object, state: list[object]) -> None:
        for each, value in zip(fields(self), state, strict=True):
            object.__setattr__(self, each.name, value)
