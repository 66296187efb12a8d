"""Bayesian identification of nonlinear systems, from equations written as on paper.

``sysid.load("duffing.sysid")`` reads a file of the language and returns a `Model`: the posterior density as a function of
arrays, for samplers and optimisers of other packages. The same files run at the command line (``sysid run duffing.sysid``), with
the same numbers. In a notebook, ``%load_ext sysid`` lets cells that begin with ``%%sysid`` be such files.
"""

from ._engine import instruction_set, version as __version__
from ._error import Error, ModelWarning
from ._language import Completion, completions, explain, hover
from ._model import Mode, Model, Parameter, Simulation, load, loads
from ._results import Check, Comparison, Result, compare

__all__ = [
    "Check",
    "Comparison",
    "Completion",
    "Error",
    "Mode",
    "Model",
    "ModelWarning",
    "Parameter",
    "Result",
    "Simulation",
    "compare",
    "completions",
    "explain",
    "hover",
    "instruction_set",
    "load",
    "loads",
]


def load_ipython_extension(shell: object) -> None:
    """``%load_ext sysid``."""
    from . import _notebook

    _notebook.load(shell)


def unload_ipython_extension(shell: object) -> None:
    """``%unload_ext sysid``."""
    from . import _notebook

    _notebook.unload(shell)
