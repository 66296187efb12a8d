"""Cells of a notebook in the language: ``%load_ext sysid``, then ``%%sysid``."""

from __future__ import annotations

import builtins
import keyword
import os
import sys
import types
from typing import Any, Optional

from IPython.core.magic import Magics, cell_magic, magics_class
from IPython.core.magic_arguments import argument, magic_arguments, parse_argstring
from IPython.display import display

from . import _language, _progress
from ._error import Error
from ._model import Model
from ._numbers import whole
from ._results import Result
from ._words import in_cell

_MAGIC = "%%sysid"


class CellError(Error):
    """An error of a cell; what is shown of it is the message, whose lines are those of the cell."""

    def _render_traceback_(self) -> list[str]:
        return in_cell(str(self)).splitlines()


class CellInterrupt(KeyboardInterrupt):
    """Ctrl-C before there was a result."""

    def _render_traceback_(self) -> list[str]:
        return ["interrupted"]


class _Mistake(Exception):
    """In the options of a cell."""


def _bindable(name: str) -> bool:
    return name.isidentifier() and not keyword.iskeyword(name)


def _taken(name: str, variables: dict) -> str:
    """What a name stands for that a notebook would miss; "" where nothing."""
    if hasattr(builtins, name):
        return "a name of Python"
    return "a module" if name == "sysid" or isinstance(variables.get(name), types.ModuleType) else ""


@magics_class
class SysidMagics(Magics):
    def __init__(self, shell: Any) -> None:
        super().__init__(shell)
        self._folder = os.getcwd()  # where kernels begin: the notebook's folder, wherever the user goes from there

    def folder(self) -> str:
        """From which paths in cells are relative."""
        of_editor = self.shell.user_ns.get("__vsc_ipynb_file__")
        return os.path.dirname(of_editor) if of_editor else self._folder

    def path(self, name: Optional[str]) -> str:
        """Of the file that a cell would be; beside the notebook. Messages name it."""
        return os.path.normpath(os.path.join(os.path.relpath(self.folder()), f"{name or 'cell'}.sysid"))

    @magic_arguments()
    @argument("name", nargs="?", help="the name that the model is bound to")
    @argument("--data", help="a variable with the data, which then need no `file` line: a mapping, a pandas frame or an xarray data set")
    @argument("--seed", type=int, help="of all random numbers, in place of those in the cell")
    @argument("--output", help="the folder of results; by default a temporary one of each")
    @argument("--force", action="store_true", help="replace results that are in the folder")
    @argument("--threads", type=int, default=0, help="0: one for each processor")
    @cell_magic
    def sysid(self, line: str, cell: str) -> None:
        """Runs the tasks of a cell that is a file of the language, shows their results and binds them to the names of the tasks."""
        asked = parse_argstring(self.sysid, line)
        if asked.name and not _bindable(asked.name):
            raise CellError(f"sysid: error: `{asked.name}` is no name for a variable\nhelp: write `%%sysid NAME`")
        if asked.name and (taken := _taken(asked.name, self.shell.user_ns)):
            raise CellError(f"sysid: error: `{asked.name}` is {taken}, which the model would replace\nhelp: choose another name")
        if asked.force and not asked.output:
            raise CellError("sysid: error: there is no folder whose results could be replaced\nhelp: name it: --output DIR")
        try:
            self._run(asked, cell)
        except Error as error:
            raise CellError(str(error), error._details) from None
        except _Mistake as error:
            raise CellError(f"sysid: error: {error}") from None
        except KeyboardInterrupt:
            raise CellInterrupt from None

    def _bind(self, name: str, result: Result, model: Optional[str]) -> None:
        """To the name of its task, unless that stands for something that the notebook would miss."""
        taken = "the name of the model" if name == model else _taken(name, self.shell.user_ns)
        if _bindable(name) and not taken:
            self.shell.user_ns[name] = result
        elif taken:
            place = f"{model}.results[{name!r}]" if model else "the results of the model, if `%%sysid NAME` names it"
            print(f"`{name}` is {taken} and is not replaced; the result of the task is in {place}", file=sys.stderr)

    def _run(self, asked: Any, cell: str) -> None:
        data = None
        if asked.data:
            if asked.data not in self.shell.user_ns:
                raise Error(f"sysid: error: there is no variable `{asked.data}`\nhelp: --data names a variable of the notebook")
            data = self.shell.user_ns[asked.data]
        try:  # here alone: elsewhere such an exception would be a fault of the module, whose place is of use
            if asked.seed is not None:
                whole(asked.seed, "--seed", 2**64 - 1)
            threads = whole(asked.threads, "--threads", 4096)
            model = Model(self.path(asked.name), cell, data, None, threads)
        except (TypeError, ValueError) as error:
            raise _Mistake(str(error)) from None
        if asked.name:
            self.shell.user_ns[asked.name] = model
        if not model.tasks:
            display(model)
        for name, verb in model.tasks:
            shown = display({"text/plain": f"{name} ..."}, raw=True, display_id=True)
            options = {"output": asked.output, "force": asked.force} if asked.output else {}
            try:
                result = model._run(verb, name, seed=asked.seed, progress=_progress.Bar(shown), **options)
            except BaseException:
                shown.update({"text/plain": ""}, raw=True)
                raise
            shown.update(result)
            self._bind(name, result, asked.name)
            if result.interrupted:
                break


class Assistance:
    """Answers the kernel's questions about cells in the language; passes others on."""

    def __init__(self, kernel: Any, magics: SysidMagics) -> None:
        self._kernel, self._magics = kernel, magics
        self._complete, self._inspect = kernel.do_complete, kernel.do_inspect
        kernel.do_complete, kernel.do_inspect = self.do_complete, self.do_inspect

    def remove(self) -> None:
        del self._kernel.do_complete, self._kernel.do_inspect

    def _place(self, code: str, position: Optional[int]) -> Optional[tuple[str, int, int]]:
        """The text of a cell in the language, the place in it, and where it begins in the cell; None elsewhere."""
        position = len(code) if position is None else position
        head, _, text = code.partition("\n")
        begin = len(head) + 1
        if head.split(" ", 1)[0] != _MAGIC or position < begin:
            return None
        return text, position - begin, begin

    def do_complete(self, code: str, cursor_pos: Optional[int]) -> Any:
        place = self._place(code, cursor_pos)
        if place is None:
            return self._complete(code, cursor_pos)
        text, position, begin = place
        first, last, found = _language.completions(text, position, self._magics.path(None))
        types = [
            {"start": begin + first, "end": begin + last, "text": each.label, "type": each.detail, "signature": each.summary}
            for each in found
        ]
        return {
            "status": "ok",
            "matches": [each.label for each in found],
            "cursor_start": begin + first,
            "cursor_end": begin + last,
            "metadata": {"_jupyter_types_experimental": types},
        }

    def do_inspect(self, code: str, cursor_pos: Optional[int], *arguments: Any, **options: Any) -> Any:
        place = self._place(code, cursor_pos)
        if place is None:
            return self._inspect(code, cursor_pos, *arguments, **options)
        markdown = _language.hover(place[0], place[1], self._magics.path(None))
        data = {"text/plain": markdown, "text/markdown": markdown} if markdown else {}
        return {"status": "ok", "found": bool(markdown), "data": data, "metadata": {}}


_assistance: Optional[Assistance] = None


def load(shell: Any) -> None:
    global _assistance
    magics = SysidMagics(shell)
    shell.register_magics(magics)
    kernel = getattr(shell, "kernel", None)
    if kernel is not None and _assistance is None:
        _assistance = Assistance(kernel, magics)


def unload(shell: Any) -> None:
    global _assistance
    if _assistance is not None:
        _assistance.remove()
        _assistance = None
