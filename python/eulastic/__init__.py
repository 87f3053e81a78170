"""Runs of Eulastic, soft bodies in incompressible flow: start them, sweep over options, read what they wrote.

    run = eulastic.read("output/mine")
    run = eulastic.run("mine.opts", "output/stiff", rbc_shear_modulus=0.05)
    table = eulastic.sweep("mine.opts", {"rbc_shear_modulus": [0.01, 0.02, 0.05]}, jobs=3)
"""
from .reading import Run, Snapshot, is_finished, read_options
from .running import RunError, run, sweep

read = Run

__all__ = ["Run", "RunError", "Snapshot", "is_finished", "read", "read_options", "run", "sweep"]
