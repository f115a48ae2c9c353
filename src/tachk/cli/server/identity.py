"""Which server a program may use: one that started as the program did. Imports nearly nothing: the client pays."""

from __future__ import annotations

import os
import sys
from stat import S_ISDIR
from zlib import crc32

import tachk

_INHERITED = ("PYTHON", "LC_", "LANG", "LD_", "DYLD_", "MALLOC_", "GLIBC_", "OMP_", "OPENBLAS_", "MKL_")
"""The beginnings of the names of variables that a process reads when it starts, and a copy of the server could not."""

_NAMESPACES = ("mnt", "pid", "net")
"""What Linux can show to one process and not to another: files, processes, interfaces."""

_OPTIONS_WITH_VALUE = ("-W", "-X")


def interpreter_options() -> list[str]:
    """The options of Python itself that this program was started with."""
    options: list[str] = []
    words = iter(sys.orig_argv[1:])
    for word in words:
        if not word.startswith("-") or word == "-":
            break
        if word in _OPTIONS_WITH_VALUE:
            options += (word, next(words, ""))
            continue
        ends = 0 if word.startswith((*_OPTIONS_WITH_VALUE, "--")) else _first(word, "mc")
        if ends:  # what follows names the program
            options += [word[:ends]] if ends > 1 else []
            break
        options.append(word)
    return options


def _first(word: str, letters: str) -> int:
    """The place of the first of some letters; 0 if there is none."""
    return next((place for place, letter in enumerate(word) if letter in letters), 0)


def key() -> str:
    """What a process has from its start, as a text: programs with the same one do the same with the same request."""
    return "\n".join([tachk.__version__, package_folder(), sys.executable, *interpreter_options(), *_circumstances()])


def key_of_scripts(folder: str) -> str:
    """The key of the program `tachkc` in a folder of scripts, which does not know what Python loads."""
    return "\n".join([tachk.__version__, folder, *_circumstances()])


def package_folder() -> str:
    """The folder of the package tachk."""
    return os.path.dirname(os.path.abspath(tachk.__file__))


def _circumstances() -> list[str]:
    """What a process has from its caller and cannot change."""
    root = os.stat("/")
    try:
        namespaces = [os.readlink(f"/proc/self/ns/{kind}") for kind in _NAMESPACES]
    except OSError:
        namespaces = []
    started = sorted(f"{name}={value}" for name, value in os.environ.items() if name.startswith(_INHERITED))
    rights = (os.getuid(), os.getgid(), *sorted(os.getgroups()))
    return [*started, " ".join(map(str, rights)), f"{root.st_dev} {root.st_ino}", *namespaces]


def private_folder() -> str:
    """The folder of sockets, which only its user may open. It need not be there."""
    runtime = os.environ.get("XDG_RUNTIME_DIR", "")
    if os.path.isabs(runtime) and _is_own(runtime):
        return os.path.join(runtime, "tachk")
    return os.path.join(os.environ.get("TMPDIR") or "/tmp", f"tachk-{os.getuid()}")


def _is_own(folder: str) -> bool:
    """False for the folder of another user, as after `sudo`."""
    try:
        return os.stat(folder).st_uid == os.getuid()
    except OSError:
        return False


def usual_socket(of: str) -> str:
    """The path of the socket of the server with this key."""
    return os.path.join(private_folder(), f"{crc32(of.encode(errors='surrogateescape')):08x}.sock")


def mistake_of_folder(folder: str) -> str:
    """Why a folder is not private; empty if it is. Raises OSError where it cannot be seen."""
    found = os.lstat(folder)
    if not S_ISDIR(found.st_mode):
        return "it is not a folder"
    if found.st_uid != os.getuid():
        return "it belongs to another user"
    if found.st_mode & 0o077:
        return f"others may open it: its mode is {found.st_mode & 0o777:o}"
    return ""
