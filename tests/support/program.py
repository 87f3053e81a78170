"""The program and its launcher, with the settings of scripts/environment.

Needs EULASTIC=path of the binary; EULASTIC_MPIEXEC for several ranks.
"""
import os
import pathlib
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "scripts/lib"))
import program_environment  # noqa: E402, F401

BINARY = os.environ["EULASTIC"]
MPIEXEC = os.environ.get("EULASTIC_MPIEXEC", "mpiexec")


def launcher(ranks=1):
    """The words before a program that runs on `ranks` ranks. One rank starts without mpiexec, and without a directory of Open
    MPI, which ranks that end meanwhile may remove."""
    return [MPIEXEC, "-n", str(ranks)] if ranks > 1 else ["env", "OMPI_MCA_orte_create_session_dirs=0"]
