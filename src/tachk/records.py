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
    from collections.abc import Callable, Iterator

    _FIELDS = "__dataclass_fields__"
    _MISSING = dataclasses.MISSING

    class _Factory:
        """Stands for the default of a parameter whose value comes from a function."""

        def __repr__(self) -> str:
            return "<factory>"

    _FACTORY = _Factory()

    class _Parameters:
        """What standard classes ask of those they inherit from."""

        init = repr = match_args = True
        eq = order = unsafe_hash = frozen = kw_only = slots = weakref_slot = False

    def dataclass(*, frozen: bool = False, slots: bool = False, eq: bool = True) -> Callable[[type], type]:
        """`dataclasses.dataclass` with these options; the fields, and what the methods do, are the same.

        There are no `ClassVar`, no `InitVar` and no `KW_ONLY`.
        """

        def decorate(plain: type) -> type:
            fields = _fields(plain)
            cls = _with_slots(plain, fields) if slots else plain
            setattr(cls, _FIELDS, fields)
            cls.__dataclass_params__ = _Parameters
            cls.__match_args__ = tuple(each.name for each in fields.values() if each.init and not each.kw_only)
            cls.__doc__ = cls.__doc__ or cls.__name__
            names = ["__init__", "__repr__", *(["__eq__"] if eq else ()), *(["__hash__"] if eq and frozen else ())]
            for name in names:
                if name not in plain.__dict__ or (name == "__hash__" and plain.__hash__ is None):
                    setattr(cls, name, _placeholder(cls, name, frozen))
            if eq and not frozen and "__hash__" not in plain.__dict__:
                cls.__hash__ = None
            if frozen:
                cls.__setattr__, cls.__delattr__ = _assign, _delete
            if frozen and slots:
                cls.__getstate__, cls.__setstate__ = _state, _restore
            cls.__signature__ = _Signature()
            return cls

        return decorate

    def _fields(plain: type) -> dict[str, dataclasses.Field]:
        """Those of the classes it inherits from, and its own, whose defaults become attributes of the class."""
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

    def _with_slots(plain: type, fields: dict[str, dataclasses.Field]) -> type:
        """The same class with slots for its fields; a class cannot get them after it was made."""
        there = {slot for base in plain.__mro__[1:-1] for slot in base.__dict__.get("__slots__", ())}
        left_out = {*fields, "__dict__", "__weakref__"}
        members = {name: value for name, value in plain.__dict__.items() if name not in left_out}
        members["__slots__"] = tuple(name for name in fields if name not in there)
        cls = type(plain)(plain.__name__, plain.__bases__, members)
        cls.__qualname__ = plain.__qualname__
        return cls

    def _placeholder(cls: type, name: str, frozen: bool) -> Callable[..., object]:
        """A method that puts the real one in its place and calls it."""

        def method(self: object, *arguments: object, **named: object) -> object:
            compiled = _compiled(cls, name, frozen)
            setattr(cls, name, compiled)
            return compiled(self, *arguments, **named)

        method.__name__ = name
        method.__qualname__ = f"{cls.__qualname__}.{name}"
        method.__module__ = cls.__module__
        method.is_placeholder = True
        return method

    def _compiled(cls: type, name: str, frozen: bool) -> Callable[..., object]:
        """One method, as the standard decorator would write it."""
        fields = dataclasses.fields(cls)
        known = {"assign": object.__setattr__, "made": _FACTORY}
        match name:
            case "__init__":
                lines = _init_lines(cls, fields, frozen, known)
            case "__repr__":
                shown = ", ".join(f"{each.name}={{self.{each.name}!r}}" for each in fields if each.repr)
                lines = ["(self):", f"return f'{{self.__class__.__qualname__}}({shown})'"]
            case "__eq__":
                mine, others = (
                    "".join(f"{whose}.{each.name}," for each in fields if each.compare) for whose in ("self", "other")
                )
                lines = ["(self, other):", "if other.__class__ is not self.__class__: return NotImplemented"]
                lines.append(f"return ({mine}) == ({others})")
            case _:
                hashed = [each for each in fields if (each.compare if each.hash is None else each.hash)]
                lines = ["(self):", "return hash((" + "".join(f"self.{each.name}," for each in hashed) + "))"]
        exec(f"def {name}" + "\n ".join(lines), known)
        method = known[name]
        if name == "__repr__":
            from reprlib import recursive_repr

            method = recursive_repr()(method)
        method.__qualname__ = f"{cls.__qualname__}.{name}"
        method.__module__ = cls.__module__
        return method

    def _init_lines(
        cls: type, fields: tuple[dataclasses.Field, ...], frozen: bool, known: dict[str, object]
    ) -> Iterator[str]:
        """The lines of ``__init__``; what they need is added to what is known there."""
        parameters = []
        body = []
        for each in sorted(fields, key=lambda each: each.kw_only):
            default, factory = f"default_{each.name}", f"factory_{each.name}"
            known[default], known[factory] = each.default, each.default_factory
            if each.kw_only and "*" not in parameters:
                parameters.append("*")
            value = each.name if each.init else default
            if each.default_factory is not _MISSING:
                known[default] = _FACTORY
                value = f"{factory}() if {each.name} is made else {each.name}" if each.init else f"{factory}()"
            has_default = each.default is not _MISSING or each.default_factory is not _MISSING
            if each.init:
                parameters.append(f"{each.name}={default}" if has_default else each.name)
            if each.init or has_default:
                body.append(f"assign(self, {each.name!r}, {value})" if frozen else f"self.{each.name} = {value}")
        if hasattr(cls, "__post_init__"):
            body.append("self.__post_init__()")
        yield f"(self, {', '.join(parameters)}):"
        yield from body or ["pass"]

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
