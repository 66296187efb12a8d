"""What messages advise at a shell, as it is written in Python."""

from __future__ import annotations

import json
import re
from typing import Optional

# Verbs that are methods of a model.
_METHODS = "fit|predict|select|discover|check"
# A path as a word of a shell.
_PATH = r"'[^']*'|[^\s',`]+"


def _text(path: str) -> str:
    """A word of a shell as a string of Python."""
    return json.dumps(path.strip("'"), ensure_ascii=False)


_REPLACED = [(re.compile(pattern), replacement) for pattern, replacement in (
    (rf"sysid run FILE -o ({_PATH}), or sysid ({_METHODS}) FILE -o ({_PATH})",
     lambda found: f"model.{found[2]}(output={_text(found[1])})"),
    (rf"sysid run FILE, or sysid ({_METHODS}) FILE", r"model.\1()"),
    (rf"`?sysid ({_METHODS}) FILE --(force|resume) -o ({_PATH})`?",
     lambda found: f"model.{found[1]}({found[2]}=True, output={_text(found[3])})"),
    (rf"`?sysid ({_METHODS}) FILE --(force|resume)`?", r"model.\1(\2=True)"),
    (rf"`?sysid ({_METHODS}) FILE`?(?! --)", r"model.\1()"),
    (r"`sysid check`", "model.check()"),
    (r"more: sysid explain (\w+)", r'more: sysid.explain("\1")'),
    (r"`sysid fit FILE --with-disturbance` \(at the prompt `disturb`\) adds `([^`]+)` to the model and compares both fits",
     r"declare `\1` in the model, add `w` to its equation, and set both fits side by side with `sysid.compare`"),
    (r"paths are relative to the folder of the \.sysid file",
     "paths are relative to the folder of the .sysid file, of `loads` to its `folder`; `data` takes arrays in their place"),
    (r"`sysid explain (\w+)`", r'sysid.explain("\1")'),
    (r"--(force|resume)\b", r"\1=True"),
    (r"(?<![\w-])-o DIR\b", "output=DIR"),
    (r"another -o\b", "another output"),
)]


# Of files, where the data are arrays.
_OF_ARRAYS = [(re.compile(pattern), replacement) for pattern, replacement in (
    (r"(?<= \(arrays\)` )row (\d+) \(line \d+\)", lambda found: f"row {found[1]} (index {int(found[1]) - 1})"),
    (r"is an empty cell or NA\b", "is NaN, None or masked"),
    (r"if the file contains two runs, divide it into two files", "if there are two runs, give each a data block of its own"),
    (r"rows are numbered from 1 below the header", "rows are numbered from 1"),
)]
_ARRAYS = " (arrays)`"


def in_python(text: str, of_arrays: Optional[bool] = None) -> str:
    """A message of the engine. of_arrays: whether it is about arrays; by default as its text says."""
    for pattern, replacement in _REPLACED:
        text = pattern.sub(replacement, text)
    if of_arrays or (of_arrays is None and _ARRAYS in text):
        for pattern, replacement in _OF_ARRAYS:
            text = pattern.sub(replacement, text)
    return text


def diagnostic_in_python(diagnostic: dict) -> dict:
    """A message of the engine in its parts."""
    of_arrays = _ARRAYS in diagnostic.get("message", "")
    return {**diagnostic, **{key: in_python(diagnostic[key], of_arrays) for key in ("message", "help") if diagnostic.get(key)}}


# Of cells, which have options in place of arguments, and no `resume`.
_OF_CELLS = [(re.compile(pattern), replacement) for pattern, replacement in (
    (r"continue with resume=True, or start again with (?=force=True)", "start again with "),
    (r"(?<![(\w])force=True\b", "--force"),
    (r"(?<![(\w])output=DIR\b", "--output DIR"),
    (r"another output\b", "another --output"),
)]


def in_cell(text: str) -> str:
    """A message in Python's words, as it is written in the first line of a cell."""
    for pattern, replacement in _OF_CELLS:
        text = pattern.sub(replacement, text)
    return text
