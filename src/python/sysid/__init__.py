"""Bayesian identification of nonlinear systems, from equations written as on paper.

``sysid.load("duffing.sysid")`` reads a file of the language and returns a `Model`: the posterior density as a function of
arrays, for samplers and optimisers of other packages. The same files run at the command line (``sysid run duffing.sysid``), with
the same numbers.
"""

from ._engine import instruction_set, version as __version__
from ._error import Error, ModelWarning
from ._model import Mode, Model, Parameter, Simulation, load, loads
from ._results import Check, Comparison, Result, compare

__all__ = [
    "Check",
    "Comparison",
    "Error",
    "Mode",
    "Model",
    "ModelWarning",
    "Parameter",
    "Result",
    "Simulation",
    "compare",
    "instruction_set",
    "load",
    "loads",
]
