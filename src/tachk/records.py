"""The standard ``dataclass``, but each method is compiled when it is first called.

The standard decorator compiles six functions for every class while its module is imported. Over some hundred classes,
most of whose methods are never called in one run, that was half of the start of the program.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

__all__ = ["dataclass"]

if TYPE_CHECKING:
    from dataclasses import dataclass
else:
    import dataclasses
    import inspect
    from collections.abc import Callable

    def dataclass(*, frozen: bool = False, slots: bool = False, eq: bool = True) -> Callable[[type], type]:
        """`dataclasses.dataclass` with these options; the fields, and what the methods do, are the same."""

        def decorate(plain: type) -> type:
            cls = dataclasses.dataclass(init=False, repr=False, eq=False, slots=slots)(plain)
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
        """One method as the standard decorator writes it, taken from a class with the same fields."""
        keys = ("default", "default_factory", "init", "repr", "hash", "compare", "kw_only")
        specifications = [
            (each.name, each.type, dataclasses.field(**{key: getattr(each, key) for key in keys}))
            for each in dataclasses.fields(cls)
        ]
        namespace = {"__post_init__": cls.__post_init__} if hasattr(cls, "__post_init__") else {}
        twin = dataclasses.make_dataclass(
            cls.__name__,
            specifications,
            namespace=namespace,
            frozen=frozen,
            init=name == "__init__",
            repr=name == "__repr__",
            eq=name in ("__eq__", "__hash__"),
        )
        method = twin.__dict__[name]
        method.__qualname__ = f"{cls.__qualname__}.{name}"
        method.__module__ = cls.__module__
        return method

    class _Signature:
        """``__signature__`` of a class whose ``__init__`` may not be compiled yet."""

        def __get__(self, instance: object, owner: type) -> inspect.Signature:
            method = owner.__init__
            if getattr(method, "is_placeholder", False):
                for cls in owner.__mro__:
                    if cls.__dict__.get("__init__") is method:
                        method = _compiled(cls, "__init__", cls.__setattr__ is _assign)
            whole = inspect.signature(method)
            return whole.replace(parameters=list(whole.parameters.values())[1:])

    def _assign(self: object, name: str, value: object) -> None:
        raise dataclasses.FrozenInstanceError(f"cannot assign to field {name!r}")

    def _delete(self: object, name: str) -> None:
        raise dataclasses.FrozenInstanceError(f"cannot delete field {name!r}")

    def _state(self: object) -> list[object]:
        return [getattr(self, each.name) for each in dataclasses.fields(self)]

    def _restore(self: object, state: list[object]) -> None:
        for each, value in zip(dataclasses.fields(self), state, strict=True):
            object.__setattr__(self, each.name, value)
