"""A model with its data as a function of arrays."""

from __future__ import annotations

import ctypes
import operator
import os
import warnings
from dataclasses import dataclass
from typing import Any, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _display, _engine, _progress, _records
from ._error import Error, ModelWarning
from ._numbers import whole
from ._opened import Opened, placed
from ._results import Check, Folder, Result, keep_apart, stamp, take_along
from ._words import in_python

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Parameter:
    """A parameter that has a prior, as the file declares it."""

    name: str
    unit: str  #: as written; "" where it has none
    prior: str  #: "log_uniform(0.1, 10)"
    lower: float  #: end of the prior's support, declared unit; -inf: none, or it depends on other parameters
    upper: float


@dataclass(frozen=True)
class Mode:
    """A maximum of the posterior with its Gaussian approximation, as the search of a fit finds it."""

    theta: Array  #: [P] unconstrained coordinates
    values: Array  #: [P] declared units
    sd: Array  #: [P] declared units
    covariance: Array  #: [P x P] of theta
    log_density: float  #: at theta, as `Model.log_density` has it
    share: float  #: of the posterior's mass, by the approximations of all modes


@dataclass(frozen=True)
class Simulation:
    """What W parameter vectors predict along the N rows of an experiment."""

    experiment: str  #: "bench.train"
    time: Array  #: [N] in seconds
    values: dict[str, Array]  #: by quantity (channels, states, derived quantities) [W x N], without noise; NaN where the solve failed
    noisy: dict[str, Array]  #: by channel [W x N], with one draw of the noise
    units: dict[str, str]  #: by quantity


def _by_names(given: Any, names: Sequence[str]) -> Any:
    """A pandas frame or series in the order of the parameters that it names."""
    labels = list(getattr(given, "columns", getattr(given, "index", []))) if hasattr(given, "to_numpy") else []
    if not labels or not all(isinstance(each, str) for each in labels):
        return given
    if sorted(labels) != sorted(names):
        raise ValueError(f"expected the parameters {', '.join(names)}, not {', '.join(labels)}")
    return given[list(names)]


def _one_or_many(given: ArrayLike, density: _engine.Density) -> tuple[Array, bool]:
    """An array [W x P], and whether one vector [P] was given. What is masked is NaN."""
    dimension = density.dimension
    if hasattr(given, "to_numpy"):
        given = _by_names(given, [each[0] for each in density.parameters])
    if np.asarray(given).dtype.kind in "cmM":
        raise TypeError(f"expected real numbers, not {np.asarray(given).dtype}")
    masked = np.ma.isMaskedArray(given)
    array = given.astype(np.float64).filled(np.nan) if masked else np.asarray(given, dtype=np.float64)
    if array.ndim == 2 and len(array) == 0 and array.shape[1] != dimension:
        raise ValueError(f"expected an array [W x {dimension}], one parameter vector in each row, not {array.shape}")
    if array.ndim == 1:
        if array.shape[0] != dimension:
            raise ValueError(f"expected a vector of {dimension} parameters, or an array [W x {dimension}], not {array.shape}")
        return array[np.newaxis, :], True
    return array, False


def _flag(value: Any, what: str) -> bool:
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{what} is True or False, not {value!r}")
    return bool(value)


def _experiment(value: Any, names: Sequence[str]) -> int:
    """The number of an experiment that is named, or numbered from 0. A block stands for its only part."""
    told = ", ".join(f"{number}: {name!r}" for number, name in enumerate(names))
    if isinstance(value, str):
        found = [number for number, name in enumerate(names) if name == value]
        found = found or [number for number, name in enumerate(names) if name.split(".")[0] == value]
        if len(found) != 1:
            raise KeyError(f"{value!r} does not name exactly one experiment of the fit; it has {told}")
        return found[0]
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"experiment is a name or a number, not {value!r}; the fit has {told}") from None
    if not 0 <= number < len(names):
        raise IndexError(f"the fit has no experiment {number}; it has {told}")
    return number


def _text(value: Any) -> str:
    if not isinstance(value, str):
        raise TypeError(f"the text of a model is a str, not {type(value).__name__}")
    try:
        value.encode()
    except UnicodeEncodeError as error:
        raise ValueError(f"the text of a model has an invalid character, {value[error.start]!r} at position {error.start}") from None
    return value


def _seed(value: Any) -> int:
    return whole(value, "seed", 2**64 - 1)


class Model:
    """A file of the language with its data: made by `load` or `loads`.

    W parameter vectors are the rows of an array [W x P], the P parameters stand in the order of `parameters`; one vector [P] is
    taken as well, and gives a result without the axis W. A batch of many vectors costs far less than as many calls.

    ``theta`` are unconstrained coordinates, any numbers: what samplers move. ``values`` are the parameters themselves in the
    units that the file declares. `constrain` and `unconstrain` lead from one to the other.

    Methods release the interpreter lock and may be called from several threads. A model can be pickled.
    """

    def __init__(
        self,
        path: str,
        text: Optional[str] = None,
        data: Any = None,
        task: Optional[str] = None,
        threads: int = 0,
    ) -> None:
        threads = whole(threads, "threads", 4096)
        self._task, self._threads = task, threads
        self._prepared: Optional[int] = None
        self._folder: Optional[Folder] = None
        self._begin(Opened(os.fspath(path), text, {}, data is not None))
        if data is not None:
            self._folder = Folder()
            records = _records.write(data, self._file.data, str(self._folder.path))  # blocks need no `file` line
            self._begin(Opened(self.path, self._file.content, records))
        if self._file.warnings:
            warnings.warn(in_python(self._file.warnings), ModelWarning, stacklevel=3)

    def _begin(self, opened: Opened) -> None:
        self._opened, self._process = opened, os.getpid()
        self._made: Optional[_engine.Density] = None
        self._results: dict[str, Result] = {}
        self._runs: dict[str, Folder] = {}  # where each task ran last, though there may be no result

    @property
    def _file(self) -> _engine.File:
        return self._opened.file

    @property
    def _density(self) -> _engine.Density:
        # Threads of the engine do not come along into a forked process, where nothing may wait for them: what has them is never freed.
        if self._made is not None and self._process != os.getpid():
            ctypes.pythonapi.Py_IncRef(ctypes.py_object(self._made))
            self._made = None
        if self._made is None:
            self._process = os.getpid()
            made = _engine.Density(self._file, self._task or "", self._threads)
            if self._prepared is not None:
                made.prepare(self._prepared)
            self._made = made
        return self._made

    def __getstate__(self) -> dict:
        # What it was made of, whatever has become of the file and of the arrays.
        return {
            **self._opened.stored(),
            "task": self._task,
            "threads": self._threads,
            "records": _records.contents(self._opened.records),
            "prepared": self._prepared,
        }

    def __setstate__(self, stored: dict) -> None:
        self._task, self._threads, self._prepared = stored["task"], stored["threads"], stored["prepared"]
        self._folder = Folder() if stored["records"] else None
        records = _records.write_contents(stored["records"], self._folder.path) if self._folder else {}
        self._begin(Opened(placed(stored["path"], stored["from"]), stored["text"], records))

    # ---- what it is

    @property
    def path(self) -> str:
        """The path of the file; absolute once the working directory has changed."""
        return self._file.path

    @property
    def text(self) -> str:
        """The text of the file; what is not UTF-8 in its comments is shown as U+FFFD."""
        return self._file.text

    @property
    def tasks(self) -> list[tuple[str, str]]:
        """Names and verbs of the tasks of the file, in order: ``[("posterior", "fit")]``."""
        return self._file.tasks

    @property
    def results(self) -> dict[str, Result]:
        """The last result of each task that has been run, by the task's name."""
        return dict(self._results)

    @property
    def parameters(self) -> list[Parameter]:
        """The parameters that the fit samples, in the order of the columns of arrays."""
        return [Parameter(*each) for each in self._density.parameters]

    @property
    def names(self) -> list[str]:
        """Their names."""
        return [each.name for each in self.parameters]

    @property
    def units(self) -> list[str]:
        """Their units, as the file writes them."""
        return [each.unit for each in self.parameters]

    @property
    def dimension(self) -> int:
        """P, their number."""
        return self._density.dimension

    @property
    def residual_count(self) -> int:
        """R, the number of residuals: one for each sample that the likelihood reads, and one for each channel."""
        return self._density.residual_count

    @property
    def solver(self) -> str:
        """How finely the equations are integrated: ``"1 integrator step per sample"``; "" for a model without
        differential equations."""
        return self._density.solver

    @property
    def modes(self) -> list[Mode]:
        """What `prepare` has found, the highest first."""
        return [Mode(**each) for each in self._density.modes]

    @property
    def failures(self) -> list[dict]:
        """Simulations that failed in all calls so far: ``kind``, ``where`` in the user's words, ``count``, and the ``time`` [s] and
        the parameter values (``example``) of the first one. Their density is -inf, their simulations are NaN."""
        return self._density.failures

    # ---- the density

    def prepare(self, seed: int = 0) -> "Model":
        """Does what a fit does before it samples: finds the modes and chooses how finely the equations are integrated.

        From here on the density is the one that ``sysid fit`` samples with this seed. Before, it is that of the solver which the
        file states. Modes are good starting points of chains and optimisers. KeyboardInterrupt where Ctrl-C is pressed.
        Returns the model.
        """
        self._density.prepare(_seed(seed))
        self._prepared = _seed(seed)
        return self

    def log_density(self, theta: ArrayLike, declared: bool = False, part: str = "both") -> Union[Array, float]:
        """Log of prior times likelihood, all constants kept, [W] for an array [W x P].

        theta: unconstrained coordinates; the density is that on R^P, the Jacobian of `constrain` included. With ``declared`` they
        are values in declared units, and the density is that of the values: -inf outside the prior's support, at its bounds the
        limit from within, which may be inf.
        part: "both", "prior" or "likelihood". -inf where a simulation fails; never NaN, never an exception.
        """
        if part not in ("both", "prior", "likelihood"):
            raise ValueError(f"part is 'both', 'prior' or 'likelihood', not {part!r}")
        density = self._density
        batch, one = _one_or_many(theta, density)
        out = density.log_density(batch, declared, part) if len(batch) else np.zeros(0)
        return float(out[0]) if one else out

    def gradient(self, theta: ArrayLike) -> Array:
        """Of `log_density` by the unconstrained coordinates: [W x P]; NaN where the density is -inf."""
        return self.log_density_and_gradient(theta)[1]

    def log_density_and_gradient(self, theta: ArrayLike) -> tuple[Union[Array, float], Array]:
        """`log_density` [W] and its gradient [W x P] at unconstrained coordinates, at the cost of the gradient. NaN where there is
        no gradient: the density is -inf, or a coordinate is not finite."""
        density = self._density
        batch, one = _one_or_many(theta, density)
        if not len(batch):
            return np.zeros(0), batch
        value, gradient = density.value_and_gradient(batch)
        return (float(value[0]), gradient[0]) if one else (value, gradient)

    def residuals(self, theta: ArrayLike) -> Array:
        """Deviance residuals r [W x R] at unconstrained coordinates: log likelihood = constant - sum(r^2)/2.

        For normal noise (y - mean)/sd of each sample, and a last one for each channel that carries the scale. inf where a
        simulation fails.
        """
        density = self._density
        batch, one = _one_or_many(theta, density)
        out = density.residuals(batch) if len(batch) else np.zeros((0, density.residual_count))
        return out[0] if one else out

    def residuals_and_jacobian(self, theta: ArrayLike) -> tuple[Array, Array]:
        """`residuals` [W x R] and their derivatives by the unconstrained coordinates [W x R x P], by differences; NaN
        where a residual is not finite."""
        density = self._density
        batch, one = _one_or_many(theta, density)
        if not len(batch):
            return np.zeros((0, density.residual_count)), np.zeros((0, density.residual_count, density.dimension))
        out, jacobian = density.residuals_with_jacobian(batch)
        return (out[0], jacobian[0]) if one else (out, jacobian)

    def constrain(self, theta: ArrayLike) -> Array:
        """Values [W x P] in declared units at unconstrained coordinates [W x P]."""
        density = self._density
        batch, one = _one_or_many(theta, density)
        out = density.constrain(batch) if len(batch) else batch
        return out[0] if one else out

    def unconstrain(self, values: ArrayLike) -> Array:
        """Unconstrained coordinates [W x P] of values [W x P] in declared units; not finite outside the prior's support.

        Coordinates of unbounded priors are SI values, so their sizes may differ by many powers of ten: methods that are sensitive
        to scale, such as L-BFGS-B, want coordinates divided by the square roots of the diagonal of ``modes[0].covariance``.
        """
        density = self._density
        batch, one = _one_or_many(values, density)
        out = density.unconstrain(batch) if len(batch) else batch
        return out[0] if one else out

    def sample_prior(self, count: int, seed: int = 0) -> Array:
        """Draws of the prior, unconstrained coordinates [count x P]."""
        return self._density.sample_prior(count, _seed(seed))

    def simulate(self, values: ArrayLike, experiment: Union[int, str] = 0, seed: int = 0) -> Simulation:
        """What parameter vectors predict along the rows of an experiment of the fit.

        values: [W x P], declared units. experiment: its name, ``"bench.train"``, or its number in the fit, from 0. seed: of the
        noise in ``noisy``.
        """
        density = self._density
        number = _experiment(experiment, density.experiments)
        batch, one = _one_or_many(values, density)
        # Of no vectors the rows and quantities are those of any vector.
        some = batch if len(batch) else density.constrain(density.sample_prior(1, 0))
        made = density.simulate(some, number, _seed(seed))
        if one or not len(batch):
            for each in (made["values"], made["noisy"]):
                for name in each:
                    each[name] = each[name][0] if one else each[name][:0]
        return Simulation(**made)

    # ---- tasks

    def check(self, seed: Optional[int] = None) -> Check:
        """Reports what the data can determine, before any sampling, as ``sysid check`` does. seed: of the draws of the prior."""
        seed = None if seed is None else _seed(seed)
        return Check(*_engine.check(self._file, _engine.Asked(output="results", seed=seed, threads=self._threads)))

    def fit(self, task: Optional[str] = None, **options: Any) -> Result:
        """Runs a fit of the file: by default the one whose density this is.

        Draws, tables and findings are those of ``sysid fit``, byte for byte for a seed. Options, of all tasks:

        seed: of all random numbers, in place of the one in the file.
        output: the folder of results; by default a temporary one of this result alone.
        force: replaces results that are in `output`. resume: goes on from a checkpoint there, or from where this task of the model
        has stopped.
        figures: also draws figures. progress: a line on standard error at a terminal, a bar in a
        notebook; by default where there is either.

        Ctrl-C keeps the draws so far: the result then has ``interrupted``, and ``fit(resume=True)`` goes on to the bytes of an
        uninterrupted fit. Raises KeyboardInterrupt where there are no draws yet, and where it was pressed too late to stop the
        fit, whose result then is in `results`.
        """
        return self._run("fit", task or self._task, **options)

    def predict(self, task: Optional[str] = None, **options: Any) -> Result:
        """Runs a prediction of the file, the first by default, from the draws of the fit before it. Options as in `fit`; with
        `output` the fit's draws lie there, too."""
        return self._run("predict", task, **options)

    def select(self, task: Optional[str] = None, **options: Any) -> Result:
        """Runs a selection among the candidate models of the file, the first by default. Options as in `fit`."""
        return self._run("select", task, **options)

    def discover(self, task: Optional[str] = None, **options: Any) -> Result:
        """Runs a discovery of the file, the first by default. Options as in `fit`."""
        return self._run("discover", task, **options)

    def _run(
        self,
        verb: str,
        task: Optional[str],
        *,
        seed: Optional[int] = None,
        output: Optional[Union[str, os.PathLike]] = None,
        force: bool = False,
        resume: bool = False,
        figures: bool = False,
        progress: Any = None,
        checkpoint_interval: float = 30,
    ) -> Result:
        seed = None if seed is None else _seed(seed)
        force, resume, figures = _flag(force, "force"), _flag(resume, "resume"), _flag(figures, "figures")
        if not checkpoint_interval >= 0:
            raise ValueError(f"checkpoint_interval is a number of seconds, at least 0, not {checkpoint_interval}")
        names = [name for name, of in self.tasks if of == verb]
        name = task or (names[0] if names else "")
        if name not in names:
            known = ", ".join(f"`{each}`" for each in names) or "none"
            raise Error(f"sysid: error: this file has no {verb} task{f' `{task}`' if task else ''}\nhelp: its {verb} tasks: {known}")
        if output is None:
            run = self._folder_of_its_own(name, resume)
        else:
            run = Folder(output)
            if force or resume:
                keep_apart(run.path / name)
        before = stamp(run.path / name)
        asked = _engine.Asked(
            output=str(run.path),
            temporary=run.temporary,
            seed=seed,
            threads=self._threads,
            force=force,
            resume=resume,
            figures=figures,
            checkpoint_interval=checkpoint_interval,
        )
        with _progress.shown(progress) as told:
            exit, text, notices, requested = _engine.run(self._file, [name], asked, told)
        self._runs[name] = run
        if exit == 75 and stamp(run.path / name) in (None, before):
            raise KeyboardInterrupt
        result = Result(self._opened, self._folder, run, name, exit, text, in_python(notices))
        self._results[name] = result
        if requested and exit != 75:
            raise KeyboardInterrupt(f"`{name}` ended before the interruption took effect: its result is in model.results[{name!r}]")
        return result

    def _folder_of_its_own(self, name: str, resume: bool) -> Folder:
        """For results that nothing replaces, with what the task may read of earlier ones: draws, or its own checkpoint."""
        run = Folder()
        for earlier, verb in self.tasks:
            if earlier == name:
                if resume and name in self._runs:
                    take_along(self._runs[name], name, run, changes=True)
            elif earlier in self._results and verb != "predict":
                take_along(self._results[earlier]._run, earlier, run)
        return run

    # ---- how it looks

    def _shown(self) -> list[Parameter]:
        return self.parameters if any(verb == "fit" for _, verb in self.tasks) else []

    def __repr__(self) -> str:
        rows = [f"  {each.name} {f'[{each.unit}] ' if each.unit else ''}~ {each.prior}" for each in self._shown()]
        return "\n".join([f"sysid.Model of {self.path}", *rows])

    def _repr_html_(self) -> str:
        data = [(name, "arrays" if name in self._opened.records else path, columns) for name, path, columns in self._file.data]
        return _display.model(self.path, self._file.models, data, self.tasks)

    def _repr_latex_(self) -> str:
        return self.latex

    @property
    def latex(self) -> str:
        """Equations, priors and observations of all models as an ``align*`` of amsmath, as ``sysid export --latex`` prints them."""
        return "\n".join(latex for _, _, _, latex in self._file.models)


def load(path: Union[str, os.PathLike], data: Any = None, task: Optional[str] = None, threads: int = 0) -> Model:
    """Reads and checks a file of the language.

    path: of the .sysid file. data: in place of the tables that the data blocks name, a mapping or frame of columns; see
    docs/python.md; they are copied. Without it, tables are read when they are first needed. task: the fit whose density is
    wanted; by default the first. threads: 0 is one for each processor; results do not depend on it. Raises `Error` with the located message where something is wrong with the text or the data.
    """
    return Model(os.fspath(path), None, data, task, threads)


def loads(text: str, folder: Union[str, os.PathLike] = ".", data: Any = None, task: Optional[str] = None, threads: int = 0) -> Model:
    """As `load`, of a text instead of a file. folder: from which paths of tables and modules are relative."""
    return Model(os.path.join(os.fspath(folder), "text.sysid"), _text(text), data, task, threads)
