"""What editors ask about a text of the language: the language server's own answers."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Optional, Union

from . import _engine
from ._error import Error


@dataclass(frozen=True)
class Completion:
    """Something that may stand at a place of a text."""

    label: str  #: as it is written
    detail: str  #: what it is, or its signature; may be empty
    summary: str  #: one line; may be empty


def _bytes(text: str, position: int) -> int:
    return len(text[:position].encode())


def completions(text: str, position: int, path: Union[str, os.PathLike] = "text.sysid") -> tuple[int, int, list[Completion]]:
    """What may stand at a place of a text, as the language server offers it.

    position: of the cursor, counted in characters from 0. path: of the text, from whose folder data and modules are looked for; it
    need not exist. Returns where the word begins and ends that is written already, and all that begins like it.
    """
    begin, end, items = _engine.complete(os.fspath(path), text, _bytes(text, position))
    encoded = text.encode()
    written = encoded[begin:end].decode(errors="ignore")
    found = [Completion(*each) for each in items if each[0].lower().startswith(written.lower())]
    return len(encoded[:begin].decode(errors="ignore")), len(encoded[:end].decode(errors="ignore")), found


def hover(text: str, position: int, path: Union[str, os.PathLike] = "text.sysid") -> Optional[str]:
    """What the name at a place of a text is, as Markdown; None where there is none. Arguments as of `completions`."""
    return _engine.hover(os.fspath(path), text, _bytes(text, position))


class Page(str):
    """A text that is shown as it is."""

    __repr__ = str.__str__


def explain(code: str) -> Page:
    """The page about a message or finding, ``sysid.explain("E2103")``."""
    found = _engine.explain(code)
    if found is None:
        raise Error(f"sysid: error: there is no message `{code}`\nhelp: a message gives its code in brackets after `error` or `warning`")
    return Page(found.rstrip("\n"))
