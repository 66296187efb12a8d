"""Arrays in the place of tables: columns of a mapping, a pandas frame or an xarray data set, by the names of the data block."""

from __future__ import annotations

import numbers
import os
import pathlib
from typing import Any, Sequence

import numpy as np

from ._error import Error


def _is_frame(data: Any) -> bool:
    """Whether it holds columns itself: not a plain mapping from blocks to what holds columns."""
    return not isinstance(data, dict) or not any(_holds_columns(each) for each in data.values())


def _holds_columns(data: Any) -> bool:
    return isinstance(data, dict) or hasattr(data, "columns") or hasattr(data, "data_vars")


def _index_names(data: Any) -> list[str]:
    """Of the levels of a pandas frame's index that have names."""
    return [str(name) for name in getattr(getattr(data, "index", None), "names", []) if name is not None]


def _column(data: Any, name: str) -> Any:
    if hasattr(data, "columns") and name not in data.columns and name in _index_names(data):
        return data.index.get_level_values(name)
    if hasattr(data, "data_vars") or name in data:
        return data[name]
    # Labels need be no texts: pandas numbers columns without a name.
    return data[next(label for label in (data.keys() if hasattr(data, "keys") else data.columns) if str(label) == name)]


def _floats(given: Any, told: str) -> np.ndarray:
    """A column as numbers, NaN for what is missing. TypeError where numbers would not say all that it holds, as of complex ones."""
    masked = np.ma.isMaskedArray(given)
    array = np.asarray(given.data if masked else given)
    if array.dtype == object:  # numbers among None or pandas.NA
        missing = [each is None or type(each).__name__ == "NAType" for each in array.flat]
        strange = [each for each, absent in zip(array.flat, missing) if not absent and not isinstance(each, numbers.Real)]
        if strange:
            dates = ": subtract the first, then divide by the unit of the data block" if hasattr(strange[0], "tzinfo") else ""
            raise TypeError(f"{told} holds {type(strange[0]).__name__}, not numbers{dates}")
        try:
            values = [np.nan if absent else float(each) for each, absent in zip(array.flat, missing)]
        except OverflowError:
            raise ValueError(f"{told} holds a number beyond 1.8e308, the largest there is") from None
        array = np.array(values).reshape(array.shape)
    if array.dtype.kind not in "biuf":
        help = {
            "m": ": divide durations by the unit of the data block first",
            "M": ": subtract the first, then divide by the unit of the data block, as `(t - t[0]) / numpy.timedelta64(1, 's')`",
        }.get(array.dtype.kind, "")
        raise TypeError(f"{told} holds {array.dtype}, not numbers{help}")
    return np.where(np.ma.getmaskarray(given), np.nan, array) if masked else array.astype(np.float64)


def _names(data: Any) -> list[str]:
    if not any(hasattr(data, name) for name in ("data_vars", "keys", "columns")):
        raise TypeError(f"data are a mapping from names to columns, a pandas frame or an xarray data set, not {type(data).__name__}")
    if hasattr(data, "data_vars"):  # xarray: coordinates are columns, too
        return [str(name) for name in data.variables]
    names = [str(name) for name in (data.keys() if hasattr(data, "keys") else data.columns)]
    return names + [name for name in (_index_names(data) if hasattr(data, "columns") else []) if name not in names]


def _text(values: np.ndarray) -> list[str]:
    # The shortest number that reads back to the same bits. What is missing has a word: an empty line at the end would be no row.
    return ["NA" if np.isnan(value) else repr(float(value)) for value in values]


def _write_table(data: Any, block: str, columns: Sequence[str], path: str) -> None:
    known = _names(data)
    missing = [name for name in columns if name not in known]
    if missing:
        raise Error(
            f"sysid: error: the data for `{block}` have no column `{missing[0]}`\n"
            f"help: the data block reads {', '.join(f'`{name}`' for name in columns)}; there are {', '.join(f'`{name}`' for name in known)}"
        )
    arrays = []
    for name in columns:
        told = f"column `{name}` of the data for `{block}`"
        array = _floats(_column(data, name), told)
        if array.ndim != 1:
            raise ValueError(f"{told} has shape {array.shape}; columns have one axis")
        arrays.append(array)
    lengths = {len(array) for array in arrays}
    if len(lengths) > 1:
        raise ValueError(f"the columns of the data for `{block}` differ in length: {sorted(lengths)}")
    texts = [_text(array) for array in arrays]
    with open(path, "w", encoding="utf-8") as table:
        table.write(",".join('"' + name.replace('"', '""') + '"' for name in columns) + "\n")
        for row in zip(*texts):
            table.write(",".join(row) + "\n")


def write(data: Any, blocks: Sequence[tuple[str, str, list[str]]], folder: str) -> dict[str, str]:
    """Writes what was given as tables into a folder; returns their paths by the names of the data blocks."""
    if not blocks:
        raise Error("sysid: error: this file has no data block for these data\nhelp: add one that names the columns and their units")
    if _is_frame(data):
        if len(blocks) > 1:
            names = ", ".join(f"`{name}`" for name, _, _ in blocks)
            raise Error(
                f"sysid: error: this file has several data blocks: {names}\nhelp: give a mapping from their names to their columns"
            )
        data = {blocks[0][0]: data}
    columns = {name: list(dict.fromkeys(wanted)) for name, _, wanted in blocks}
    records = {}
    for name, table in data.items():
        if name not in columns:
            raise Error(
                f"sysid: error: there is no data block `{name}` in this file\nhelp: it has {', '.join(f'`{each}`' for each in columns)}"
            )
        path = os.path.join(folder, f"{name}.csv")
        _write_table(table, name, columns[name], path)
        records[name] = path
    return records


def contents(records: dict[str, str]) -> dict[str, bytes]:
    """Of the tables, by the names of the data blocks."""
    return {name: pathlib.Path(path).read_bytes() for name, path in records.items()}


def write_contents(tables: dict[str, bytes], folder: pathlib.Path) -> dict[str, str]:
    """Writes them into a folder; returns their paths."""
    records = {name: str(folder / f"{name}.csv") for name in tables}
    for name, path in records.items():
        pathlib.Path(path).write_bytes(tables[name])
    return records
