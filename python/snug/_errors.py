"""Exceptions of snug that Python sees."""
from __future__ import annotations

from typing import Optional


class InputError(ValueError):
    """Something a person wrote that cannot be used: a file, a key of it, an argument.

    The message has all of it in one line.

    Attributes:
        file: the file, or what stood for it ("command line", "argument").
        line: from 1, or None where there is none.
        key: the key or argument, "" where there is none.
        got: what stood there.
        expected: what would have been right, with the nearest name where there is one.
    """

    file: str = ""
    line: Optional[int] = None
    key: str = ""
    got: str = ""
    expected: str = ""


def refused(key: str, got: str, expected: str) -> InputError:
    """An argument that cannot be used."""
    error = InputError(f"argument: {key}: {got}: expected {expected}")
    error.file, error.key, error.got, error.expected = "argument", key, got, expected
    return error
