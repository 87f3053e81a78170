#!/usr/bin/python3
"""Every case of options/ for three steps with three threads, coarse, with both methods and some of their parts: the
thread sanitizer finds nothing. Needs EULASTIC, built with it (scripts/dev/sanitize --threads)."""
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/regression"))
sys.dont_write_bytecode = True
from test_cases import CASES, coarse  # noqa: E402

METHODS = ["-method fast", "-method classic"]
PARTS = ["-pressure_solver smac", "-pressure_solver ksp", "-acm_coarse false", "-solid_exterior identity",
         "-interface_scheme weno5", "-grid_cells 24,72,20"]


def races(room, case, *options):
    cells = [] if "-grid_cells" in options else ["-grid_cells", coarse(case)]
    done = subprocess.run([os.environ["EULASTIC"], ROOT / f"options/{case}.opts", *cells, *options, "-threads", "3",
                           "-time_steps_max", "3", "-series_interval", "1e-9", "-output_dir", room, "-output_overwrite"],
                          capture_output=True, text=True)
    text = done.stdout + done.stderr
    if done.returncode or "ThreadSanitizer" in text:
        print(text[:5000])
        return True
    return False


def main():
    runs = [(case, *method.split()) for case in CASES for method in METHODS]
    runs += [("channel_rbc", *method.split(), *part.split()) for method in METHODS for part in PARTS]
    with tempfile.TemporaryDirectory() as room:
        bad = [run for run in runs if races(room, *run)]
    print(f"{len(runs)} runs with three threads: {len(bad)} with races or errors", *bad, sep="\n")
    return bool(bad)


if __name__ == "__main__":
    sys.exit(main())
