"""The lines of JSON that go over the socket of a server."""

from __future__ import annotations

import json
from collections.abc import Mapping
from signal import SIGCONT, SIGHUP, SIGINT, SIGTERM, SIGTSTP, Signals
from typing import Any

from tachk.base.records import dataclass, fields

PROTOCOL_VERSION = 1

Identifier = int | str | None


class WrongMessageError(Exception):
    """A line that is no message of the protocol.

    Attributes:
        identifier: of the request, where the line has one.
    """

    def __init__(self, message: str, identifier: Identifier = None) -> None:
        super().__init__(message)
        self.identifier = identifier


@dataclass(frozen=True, slots=True)
class Request:
    """A command line to carry out.

    Attributes:
        id: of the replies to it.
        argv: the words behind `tachk`.
        cwd: the folder that relative paths are in, an absolute path.
        environment: all variables; None for those of the server.
        stdin: the standard input, where no descriptors are sent.
        umask: of files that are made; None for that of the server.
        ignored: the signals that the caller ignores.
        key: of the program that asks, see `identity.key`; None where it may be any.
        descriptors: the standard streams are the descriptors that are sent together with the line.
    """

    id: Identifier
    argv: tuple[str, ...]
    cwd: str
    environment: Mapping[str, str] | None = None
    stdin: str = ""
    umask: int | None = None
    ignored: tuple[Signals, ...] = ()
    key: str | None = None
    descriptors: bool = False


@dataclass(frozen=True, slots=True)
class SignalMessage:
    """A signal for a request that is under way."""

    id: Identifier
    signal: Signals


@dataclass(frozen=True, slots=True)
class ServerMessage:
    """A question about the server itself, or the order to end: ``status`` or ``stop``."""

    id: Identifier
    server: str


Message = Request | SignalMessage | ServerMessage

_KINDS = {"argv": Request, "signal": SignalMessage, "server": ServerMessage}
_FORWARDED = (SIGINT, SIGTERM, SIGTSTP, SIGCONT)
_IGNORABLE = {number.name: number for number in (SIGHUP, SIGINT, SIGTERM)}


def parse(line: bytes) -> Message:
    """Raises WrongMessageError, which says what is wrong."""
    try:
        given = json.loads(line)
    except (ValueError, RecursionError) as error:
        raise WrongMessageError(f"no JSON: {error}") from None
    if not isinstance(given, dict):
        raise WrongMessageError("a message is an object of JSON")
    identifier = given.get("id")
    if isinstance(identifier, bool) or not isinstance(identifier, int | str):
        raise WrongMessageError("`id` must be a number or a text, which the replies have as well")
    kinds = [kind for name, kind in _KINDS.items() if name in given]
    if len(kinds) != 1:
        raise WrongMessageError(f"a message has one of {', '.join(f'`{name}`' for name in _KINDS)}", identifier)
    known = [each.name for each in fields(kinds[0])]
    strange = next((name for name in given if name not in known), None)
    if strange is not None:
        raise WrongMessageError(f"no field `{strange}`; there are {', '.join(known)}", identifier)
    try:
        return _made(kinds[0], given)
    except WrongMessageError as error:
        raise WrongMessageError(str(error), identifier) from None


def _made(kind: type[Message], given: dict[str, Any]) -> Message:
    if kind is SignalMessage:
        number = given["signal"]
        found = next((each for each in _FORWARDED if number in (each.name, each.value)), None)
        _check(found is not None, f"`signal` must be one of {', '.join(each.name for each in _FORWARDED)}")
        assert found is not None
        return SignalMessage(given["id"], found)
    if kind is ServerMessage:
        _check(given["server"] in ("status", "stop"), "`server` must be status or stop")
        return ServerMessage(given["id"], given["server"])
    return _request(given)


def _request(given: dict[str, Any]) -> Request:
    argv, cwd = given["argv"], given.get("cwd")
    _check(_are_texts(argv), "`argv` must be a list of texts, the words behind `tachk`")
    _check(
        isinstance(cwd, str) and cwd.startswith("/") and "\0" not in cwd,
        "`cwd` must be the path of a folder, from the root",
    )
    environment = given.get("environment")
    _check(
        environment is None
        or (isinstance(environment, dict) and _are_texts([*environment.values()]) and _are_names([*environment])),
        "`environment` must be an object whose values are texts",
    )
    _check(isinstance(given.get("stdin", ""), str), "`stdin` must be a text")
    umask = given.get("umask")
    _check(umask is None or (type(umask) is int and 0 <= umask <= 0o777), "`umask` must be a number from 0 to 511")
    ignored = given.get("ignored", [])
    _check(
        isinstance(ignored, list) and all(isinstance(name, str) and name in _IGNORABLE for name in ignored),
        f"`ignored` must be a list of {', '.join(_IGNORABLE)}",
    )
    _check(isinstance(given.get("key", ""), str), "`key` must be a text")
    _check(isinstance(given.get("descriptors", False), bool), "`descriptors` must be true or false")
    _check(not (given.get("descriptors") and "stdin" in given), "`stdin` is for requests without `descriptors`")
    return Request(
        **{**given, "argv": tuple(argv), "ignored": tuple(_IGNORABLE[name] for name in ignored)},
    )


def _check(condition: bool, message: str) -> None:
    if not condition:
        raise WrongMessageError(message)


def _are_texts(values: object) -> bool:
    return isinstance(values, list) and all(isinstance(each, str) and "\0" not in each for each in values)


def _are_names(names: list[str]) -> bool:
    return all(name and "=" not in name and "\0" not in name for name in names)


def line(identifier: Identifier, **said: Any) -> bytes:
    """A reply."""
    return json.dumps({"id": identifier, **said}, separators=(",", ":")).encode("ascii") + b"\n"
