"""A line on standard error that says how far a task is."""

from __future__ import annotations

import sys
import time


class Line:
    """What the engine tells of its progress; rewritten ten times a second at most, removed at the end."""

    def __init__(self) -> None:
        self._what, self._total, self._shown, self._width = "", 0, 0.0, 0

    def begin(self, what: str, total: int) -> None:
        self._what, self._total, self._shown = what, total, 0.0

    def expect(self, total: int) -> None:
        self._total = total

    def advance(self, done: int, note: str) -> None:
        now = time.monotonic()
        if now - self._shown < 0.1:
            return
        self._shown = now
        share = f"{100 * done // self._total} %" if self._total else f"{done}"
        self._write(f"{self._what}: {share}{', ' + note if note else ''}")

    def end(self, finished: bool) -> None:
        self._write("")

    def _write(self, text: str) -> None:
        if text or self._width:
            sys.stderr.write("\r" + text.ljust(self._width) + ("" if text else "\r"))
            sys.stderr.flush()
        self._width = len(text)


def line_for(wanted: "bool | None") -> "Line | None":
    """None asks whether somebody looks: at a terminal, or in a notebook."""
    if wanted is None:
        wanted = sys.stderr.isatty() or "ipykernel" in sys.modules
    return Line() if wanted else None
