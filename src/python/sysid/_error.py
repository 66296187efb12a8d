"""Errors of models and data, with the message that the command line prints."""

from __future__ import annotations

import json

from ._words import diagnostic_in_python, in_python


class Error(Exception):
    """A mistake in a model or its data, or a file that cannot be read.

    ``str(error)`` is the whole message with the place, the line and the help, as ``sysid run`` prints it, with calls of Python in
    the place of commands.
    """

    def __init__(self, text: str, details: str = "") -> None:
        super().__init__(in_python(text))
        self._details = details

    @property
    def diagnostics(self) -> list[dict]:
        """All messages: ``file``, ``severity``, ``code``, ``message``, ``help``, and ``primary`` with its ``line`` and ``column``."""
        found = [json.loads(line) for line in self._details.splitlines() if line.strip()]
        return [diagnostic_in_python(each) for each in found]

    def _first(self, key: str):
        found = self.diagnostics
        return found[0].get(key) if found else None

    @property
    def code(self) -> str | None:
        """The code of the first message, ``"E2103"``; ``sysid.explain("E2103")`` explains it. None where it has none."""
        return self._first("code") or None

    def _place(self, key: str) -> int | None:
        return (self._first("primary") or {}).get(key)

    @property
    def line(self) -> int | None:
        """The line of the first message, counted from 1; None where it concerns no place in the text."""
        return self._place("line")

    @property
    def column(self) -> int | None:
        """The column of the first message, counted from 1; None where it concerns no place in the text."""
        return self._place("column")

    @property
    def help(self) -> str | None:
        """What to do about the first message; None where nothing is suggested."""
        return self._first("help") or None

    def __reduce__(self):
        return (Error, (self.args[0], self._details))


class ModelWarning(UserWarning):
    """Something in a model or its data that may not be meant."""
