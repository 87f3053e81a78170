"""Importing this module gives this process, and all that it starts, the settings of scripts/environment."""
import os
import pathlib
import subprocess

for line in subprocess.run([pathlib.Path(__file__).with_name("in_environment"), "env", "-0"], check=True, capture_output=True,
                           text=True).stdout.split("\0"):
    if line.startswith(("OMPI_", "OMP_")):
        name, value = line.split("=", 1)
        os.environ[name] = value
