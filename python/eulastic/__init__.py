"""Starts runs of Eulastic and sweeps over options, reads their results as numpy arrays, and computes averages.

    run = eulastic.read("output/mine")
    run = eulastic.run("mine.opts", "output/stiff", rbc_shear_modulus=0.05)
    table = eulastic.sweep("mine.opts", {"rbc_shear_modulus": [0.01, 0.02, 0.05]}, jobs=3)
"""
from . import requirements

requirements.find()

from .analysis import apparent_viscosity, cell_free_layer, pressure_drop, time_average, wall_shear  # noqa: E402
from .option_files import read_options  # noqa: E402
from .overlay import overlay  # noqa: E402
from .reading import Run, Snapshot, is_finished, over_time  # noqa: E402
from .running import RunError, run, sweep  # noqa: E402

read = Run

__all__ = ["Run", "RunError", "Snapshot", "apparent_viscosity", "cell_free_layer", "is_finished", "over_time", "overlay",
           "pressure_drop", "read", "read_options", "run", "sweep", "time_average", "wall_shear"]
