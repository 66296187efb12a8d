"""Results of tasks: numbers as NumPy and xarray have them, files as the command line writes them."""

from __future__ import annotations

import json
import os
import pathlib
import re
import shutil
import tempfile
import weakref
from typing import TYPE_CHECKING, Any, Optional, Sequence, Union

import numpy as np

from . import _display, _engine, _records
from ._error import Error
from ._numbers import whole
from ._opened import Opened, placed, working_directory
from ._words import diagnostic_in_python, in_python

if TYPE_CHECKING:
    import pandas
    import xarray


class Folder:
    """A folder for results: the user's, or a temporary one that lives as long as something refers to it."""

    def __init__(self, path: Optional[Union[str, os.PathLike]] = None) -> None:
        self.temporary = path is None
        self._given, self._from = os.fspath(path) if path is not None else tempfile.mkdtemp(prefix="sysid-"), working_directory()
        if path is None:
            weakref.finalize(self, _remove, self._given, os.getpid())

    @property
    def path(self) -> pathlib.Path:
        """As it was given, but absolute once the working directory is another."""
        return pathlib.Path(placed(self._given, self._from))


def _remove(path: str, process: int) -> None:
    if process == os.getpid():  # a forked process leaves it to the one that made it
        shutil.rmtree(path, ignore_errors=True)


def take_along(source: Folder, task: str, target: Folder, changes: bool = False) -> None:
    """Results of a task into another folder. changes: whether they will change there."""
    if not (source.path / task).is_dir():
        return
    try:
        # Nothing changes files in a temporary folder that a result is in.
        copy = os.link if source.temporary and not changes else shutil.copy2
        shutil.copytree(source.path / task, target.path / task, copy_function=copy)
    except (shutil.Error, OSError):  # a file system without links
        shutil.copytree(source.path / task, target.path / task, dirs_exist_ok=True)


def stamp(folder: pathlib.Path) -> Optional[tuple]:
    """Which summary lies in a folder of results; None: none."""
    try:
        about = os.stat(folder / "summary.json")
    except OSError:
        return None
    return about.st_ino, about.st_mtime_ns, about.st_size


class Result:
    """What a task has left. Files lie in `folder`, as the command line writes them.

    The groups of a fit are xarray data sets with the names of ArviZ's InferenceData, made when they are first asked for:
    ``posterior``, ``sample_stats``, ``log_likelihood``, ``posterior_predictive``, ``observed_data``, ``constant_data``, ``prior``,
    ``prior_predictive``, and ``predictions`` where a prediction lies beside it; of an interrupted fit the first two. A prediction
    of a fit has ``predictions`` and ``predictions_constant_data``; an average of fits and a prediction of a selection have no
    groups, but tables. A result stays what it is when tasks are run again, and can be pickled, with its files.
    """

    def __init__(self, opened: Opened, kept: Any, run: Folder, task: str, exit: int, text: str, notices: str) -> None:
        """The tables of `opened` that stand in for those of the file exist as long as `kept` does."""
        self._opened, self._kept, self._run = opened, kept, run
        self.task = task  #: its name
        if not run.temporary:
            _alive.add(self)
        self.text = text  #: the summary that the command line prints
        self.notices = notices  #: one line each: what was chosen, what was written
        self.interrupted = exit == 75  #: whether Ctrl-C has ended it; what it holds are the draws so far
        self._groups: dict[int, dict[str, "xarray.Dataset"]] = {}

    @property
    def folder(self) -> pathlib.Path:
        """The folder with its files."""
        return self._run.path / self.task

    @property
    def summary(self) -> dict:
        """The content of summary.json: parameters, verdict, findings, settings, data, versions."""
        return json.loads((self.folder / "summary.json").read_text(encoding="utf-8"))

    @property
    def verdict(self) -> str:
        """Whether the checks pass, in a sentence; "" where nothing is checked."""
        return self.summary.get("verdict", {}).get("text", "")

    @property
    def passes(self) -> bool:
        """Whether no check fails."""
        return self.summary.get("verdict", {}).get("pass", True)

    @property
    def findings(self) -> list[dict]:
        """What the checks have found: ``severity``, ``code``, ``names``, ``message``, ``help``."""
        found = self.summary.get("findings", [])
        return [diagnostic_in_python(each) for each in found]

    @property
    def parameters(self) -> dict[str, dict]:
        """By the name of a parameter or derived quantity its ``unit``, ``mean``, ``median``, ``sd``, ``q5``, ``q95``, ``rhat``,
        ``ess_bulk``, ``ess_tail``, ``mcse_mean``."""
        return self.summary.get("parameters", {})

    def table(self, name: str) -> "pandas.DataFrame":
        """A table of the results as a pandas frame: ``result.table("predict.csv")``. `files` lists them."""
        import pandas

        return pandas.read_csv(self.folder / name, comment="#")

    @property
    def files(self) -> list[str]:
        """Paths of all files, relative to `folder`."""
        return sorted(str(path.relative_to(self.folder)) for path in self.folder.rglob("*") if path.is_file())

    @property
    def figures(self) -> _display.Figures:
        """The figures by their names, ``result.figures["posterior"]``; in a notebook they are shown. Drawn when the first is asked
        for."""
        return _display.Figures(self.folder, lambda: _engine.draw_figures(str(self.folder)))

    # ---- groups

    @property
    def _verb(self) -> str:
        return self.summary.get("verb", "")

    def _why_no_groups(self) -> Optional[str]:
        """Of a prediction that is not of one fit, whose draws the groups are made of."""
        if self._verb != "predict":
            return None
        summary = self.summary
        if "average" in summary:
            return "it averages several fits, which have groups of their own"
        source = self._run.path / summary["versions"].get("made_from", "") / "summary.json"
        if source.is_file() and json.loads(source.read_text(encoding="utf-8")).get("verb") == "select":
            return "it is a prediction of a selection"
        return None

    def _inference_data(self, draws: int) -> tuple:
        run, task = self._run, self.task
        why = self._why_no_groups()
        if self._verb == "predict" and why is None:
            # The fit's file has them; of this prediction alone where nothing else lies beside it.
            task = self.summary["versions"].get("made_from", "")
            run = Folder()
            for each in (task, self.task):
                take_along(self._run, each, run)
        if why is None and (self._verb not in ("fit", "predict") or not (run.path / task).is_dir()):
            why = "it is neither a fit nor a prediction whose fit is in the same folder of results"
        if why is not None:
            raise Error(
                f"sysid: error: `{self.task}` has no groups: {why}\n"
                f"help: its tables are {', '.join(name for name in self.files if name.endswith('.csv'))}"
            )
        asked = _engine.Asked(output=str(run.path))
        return _engine.inference_data(self._opened.file, str(run.path / task), asked, 0 if self.interrupted else draws)

    def groups(self, draws: int = 200) -> dict[str, "xarray.Dataset"]:
        """All groups by their names; of a prediction of a fit ``predictions`` and ``predictions_constant_data``. draws: how
        many of the stored draws are simulated once more for likelihoods and predictive groups, all at most; 0: none, and no such groups."""
        draws = whole(draws, "draws", 10**6)
        if draws not in self._groups:
            found, attributes, _ = self._inference_data(draws)
            # Of a prediction its own; the others are the fit's.
            own_alone = self._verb == "predict"
            self._groups[draws] = {
                name: _dataset(own, dimensions, variables, attributes)
                for name, own, dimensions, variables in found
                if not own_alone or name.startswith("predictions")
            }
        return self._groups[draws]

    def __getattr__(self, name: str) -> "xarray.Dataset":
        if name.startswith("_") or name not in GROUPS:
            raise AttributeError(f"a result has no {name!r}")
        if self._verb not in ("fit", "predict"):
            raise AttributeError(f"a {self._verb} result has no group {name!r}")
        if (why := self._why_no_groups()) is not None:
            raise AttributeError(f"this result has no group {name!r}: {why}")
        groups = self.groups()
        if name not in groups:
            raise AttributeError(f"this result has no group {name!r}; it has {', '.join(groups)}")
        return groups[name]

    def __dir__(self) -> Sequence[str]:
        return [*super().__dir__(), *GROUPS]

    def to_netcdf(self, path: Union[str, os.PathLike], draws: int = 200) -> None:
        """Writes the groups as one NetCDF-4 file, byte for byte what ``sysid export`` writes; `arviz.from_netcdf` reads it. Of a
        prediction of a fit it is the file of that fit."""
        pathlib.Path(path).write_bytes(self._inference_data(whole(draws, "draws", 10**6))[2])

    def to_arviz(self, draws: int = 200) -> Any:
        """As arviz.InferenceData; ArviZ must be installed."""
        import arviz

        return arviz.InferenceData(**self.groups(draws))

    # ---- how it looks, and how it is kept

    def __repr__(self) -> str:
        return in_python(self.text).rstrip("\n") or f"sysid.Result of {self.task}"

    def _repr_html_(self) -> str:
        return _display.result(self.summary, self.text, self.interrupted)

    def __getstate__(self) -> dict:
        if not self.folder.is_dir():
            raise FileNotFoundError(f"the files of `{self.task}` are no longer in {self.folder}")
        return {
            **self._opened.stored(),
            "records": _records.contents(self._opened.records),
            "results": self._files_of_tasks(),
            "shown": {name: getattr(self, name) for name in ("task", "text", "notices", "interrupted")},
        }

    def _files_of_tasks(self) -> dict[str, bytes]:
        """Its own, and those of the other tasks of the file, on which its groups draw: fits of their predictions, and predictions of
        a fit. What else lies in a folder of the user's is none of its."""
        run = self._run.path
        names = [name for name, _ in self._opened.file.tasks]
        paths = [path for name in names for path in (run / name).rglob("*") if path.is_file()]
        return {str(path.relative_to(run)): path.read_bytes() for path in paths}

    def __setstate__(self, stored: dict) -> None:
        self._groups, self._run, self._kept = {}, Folder(), Folder()
        for name, content in stored["results"].items():
            (self._run.path / name).parent.mkdir(parents=True, exist_ok=True)
            (self._run.path / name).write_bytes(content)
        records = _records.write_contents(stored["records"], self._kept.path)
        self.__dict__.update(stored["shown"])
        self._opened = Opened(placed(stored["path"], stored["from"]), stored["text"], records)

    def _keep(self) -> None:
        """Copies its files, which are about to be replaced."""
        apart = Folder()
        take_along(self._run, self.task, apart, changes=True)
        self._run = apart


#: Results of the user's folders.
_alive: "weakref.WeakSet[Result]" = weakref.WeakSet()


def keep_apart(folder: pathlib.Path) -> None:
    """What there is of a folder of results, before a task replaces it."""
    for result in list(_alive):
        if result.folder.resolve() == folder.resolve():
            result._keep()


#: Names of ArviZ's groups that a fit may have.
GROUPS = (
    "posterior",
    "sample_stats",
    "log_likelihood",
    "posterior_predictive",
    "observed_data",
    "constant_data",
    "prior",
    "prior_predictive",
    "predictions",
    "predictions_constant_data",
)


def _dataset(own: dict, dimensions: list, variables: list, attributes: dict) -> "xarray.Dataset":
    import xarray

    sizes = dict(dimensions)
    made, coordinates = {}, {}
    for name, axes, values, notes in variables:
        array = np.asarray(values).reshape([sizes[axis] for axis in axes])
        (coordinates if list(axes) == [name] else made)[name] = (axes, array, notes)
    return xarray.Dataset(made, coordinates, {**attributes, **own})


class Check:
    """What is known of a file before any sampling."""

    def __init__(self, text: str, content: str) -> None:
        self.text = text  #: as the command line prints it
        self._content = content

    @property
    def content(self) -> dict:
        """The same as data: structure of the models, coverage of the data, what the prior predicts, what the data can determine."""
        return json.loads(self._content)

    def __repr__(self) -> str:
        return self.text.rstrip("\n")

    def _repr_html_(self) -> str:
        return _display.check(self.content, self.text)


class Comparison:
    """Fits and predictions side by side."""

    def __init__(self, text: str, content: str) -> None:
        self.text = text  #: as the command line prints it
        self._content = content

    @property
    def content(self) -> Any:
        """The same as data: evidences, probabilities of models, scores."""
        return json.loads(self._content)

    def __repr__(self) -> str:
        return self.text.rstrip("\n")

    def _repr_html_(self) -> str:
        return _display.comparison(self.content, self.text)


def compare(*results: Union[Result, str, os.PathLike]) -> Comparison:
    """Sets fits and predictions side by side: their evidence, model probabilities, errors on the same rows.

    results: what tasks have returned, or folders of tasks or of whole runs. Raises `Error` where fits are not of the same samples.
    """
    if not results:
        raise TypeError("expected at least one result or folder to compare")
    folders = [str(each.folder) if isinstance(each, Result) else os.fspath(each) for each in results]
    text, content = _engine.compare(folders)
    for folder, name in _names_of_temporary(results).items():
        # In a table the column stays as wide as it is.
        text = re.sub(re.escape(folder) + "(?=  )", lambda found: name.ljust(len(found[0])), text).replace(folder, name)
        content = content.replace(json.dumps(folder, ensure_ascii=False)[1:-1], name)
    return Comparison(text, content)


def _names_of_temporary(results: Sequence[Any]) -> dict[str, str]:
    """By their folders, whose paths tell a reader nothing: "posterior (2)" is the second of this name among those given."""
    given: dict[str, str] = {}
    for each in results:
        if isinstance(each, Result) and each._run.temporary and str(each.folder) not in given:
            count = sum(1 for name in given.values() if name.rpartition(" ")[0] == each.task)
            given[str(each.folder)] = f"{each.task} ({count + 1})"
    return given
