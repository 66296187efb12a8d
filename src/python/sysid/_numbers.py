"""Arguments that are whole numbers."""

from __future__ import annotations

import operator
from typing import Any


def whole(value: Any, what: str, most: int) -> int:
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{what} is a whole number, not {value!r}") from None
    if not 0 <= number <= most:
        raise ValueError(f"{what} is a whole number from 0 to {most}, not {number}")
    return number
