"""What messages advise at a shell, as it is written in Python."""

from __future__ import annotations

import re

# Verbs that are methods of a model.
_METHODS = "fit|predict|select|discover|check"

_REPLACED = [(re.compile(pattern), replacement) for pattern, replacement in (
    (rf"sysid run FILE, or sysid ({_METHODS}) FILE", r"model.\1()"),
    (rf"`?sysid ({_METHODS}) FILE --(force|resume)`?", r"model.\1(\2=True)"),
    (rf"`?sysid ({_METHODS}) FILE`?(?! --)", r"model.\1()"),
    (r"`sysid check`", "model.check()"),
    (r"more: sysid explain (\w+)", r'more: sysid.explain("\1")'),
    (r"`sysid explain (\w+)`", r'sysid.explain("\1")'),
    (r"--(force|resume)\b", r"\1=True"),
    (r"(?<![\w-])-o DIR\b", "output=DIR"),
    (r"another -o\b", "another output"),
)]


def in_python(text: str) -> str:
    """A message of the engine."""
    for pattern, replacement in _REPLACED:
        text = pattern.sub(replacement, text)
    return text
