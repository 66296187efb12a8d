"""A file of the language that is open, and where relative paths lead when the program changes its working directory."""

from __future__ import annotations

import os
from typing import Any, Optional, Union

from . import _engine


def working_directory() -> str:
    """"" where it has been removed, and paths lead nowhere."""
    try:
        return os.getcwd()
    except FileNotFoundError:
        return ""


def placed(path: str, folder: str) -> str:
    """A path that was relative to a working directory, as it is to be written now."""
    return path if folder in (working_directory(), "") else os.path.join(folder, path)


class Opened:
    """A file as it was when it was opened, with the tables that stand in for its own."""

    def __init__(self, path: str, text: Optional[Union[str, bytes]], records: dict[str, str], awaits_records: bool = False) -> None:
        self.records = records
        self._from = working_directory()
        self._file = _engine.File(path, text, records, awaits_records)

    @property
    def file(self) -> _engine.File:
        """Its tables are read when they are first needed, relative to the working directory of then: it is opened again, by a path
        that leads to the same place, where that is another than before."""
        now = working_directory()
        path = placed(self._file.path, self._from)
        if now and path != self._file.path:
            self._file = _engine.File(path, self._file.content, self.records)
            self._from = now
        return self._file

    def stored(self) -> dict[str, Any]:
        """What it takes to open the same text again elsewhere."""
        return {"path": self._file.path, "from": self._from, "text": self._file.content}
