"""How far a task is: a line on standard error, or a bar in a notebook."""

from __future__ import annotations

import contextlib
import html
import sys
import time
from typing import Any, Iterator, Optional


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
        self._show(done, note)

    def end(self, finished: bool) -> None:
        self._write("")

    def close(self) -> None:
        """All is over."""

    def _words(self, done: int, note: str) -> str:
        share = f"{100 * done // self._total} %" if self._total else f"{done}"
        return f"{self._what}: {share}{', ' + note if note else ''}"

    def _show(self, done: int, note: str) -> None:
        self._write(self._words(done, note))

    def _write(self, text: str) -> None:
        if text or self._width:
            sys.stderr.write("\r" + text.ljust(self._width) + ("" if text else "\r"))
            sys.stderr.flush()
        self._width = len(text)


class Bar(Line):
    """In a notebook: an output that is replaced by each newer one."""

    PATIENCE = 0.3  # what is over within these seconds needs no bar

    def __init__(self, handle: Any = None) -> None:
        """handle: the output that it is shown in, whose owner writes what stands there afterwards."""
        super().__init__()
        self._handle, self._own = handle, handle is None
        self._begun = time.monotonic()

    def end(self, finished: bool) -> None:
        pass

    def close(self) -> None:
        if self._own and self._handle is not None:
            self._handle.update({"text/plain": ""}, raw=True)

    def _show(self, done: int, note: str) -> None:
        if time.monotonic() - self._begun < self.PATIENCE:
            return
        words = self._words(done, note)
        share = f" max='{self._total}' value='{min(done, self._total)}'" if self._total else ""
        bundle = {"text/plain": words, "text/html": f"<progress{share} style='width:20em'></progress> {html.escape(words)}"}
        if self._handle is None:
            from IPython.display import display

            self._handle = display(bundle, raw=True, display_id=True)
        else:
            self._handle.update(bundle, raw=True)


def _in_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    return hasattr(ipython.get_ipython() if ipython else None, "kernel")


def line_for(wanted: Any) -> Optional[Any]:
    """None asks whether somebody looks: at a terminal, or in a notebook. What can be told itself is returned."""
    if hasattr(wanted, "begin"):
        return wanted
    notebook = _in_notebook()
    if wanted is None:
        wanted = notebook or sys.stderr.isatty()
    return (Bar() if notebook else Line()) if wanted else None


@contextlib.contextmanager
def shown(wanted: Any) -> Iterator[Optional[Any]]:
    """What is told of the progress, and closed at the end."""
    line = line_for(wanted)
    try:
        yield line
    finally:
        if isinstance(line, Line):
            line.close()
