"""Computes a fingerprint of what a program computes: two programs with the same one give the same bits in short runs of all cases of
options/."""
import concurrent.futures
import hashlib
import json
import math
import os
import pathlib
import subprocess
import tempfile

import h5py
import program_environment  # noqa: F401
from eulastic.option_files import read_options

ROOT = pathlib.Path(__file__).resolve().parents[2]
CELLS_MAX = 30000  # of a short run
STEPS = 6
OPTIONS = ["-time_steps_max", str(STEPS), "-series_interval", "0", "-snapshot_interval", "off", "-checkpoint_keep", "0",
           "-guard_energy_growth", "off"]  # coarse grids may be unstable


def identity(program):
    """Returns a text that identifies what `program` computes, to name its finished runs: EULASTIC_RESULTS, which scripts/evidence sets to
    results(), or a hash of the file."""
    return os.environ.get("EULASTIC_RESULTS") or hashlib.sha256(pathlib.Path(program).read_bytes()).hexdigest()


def coarse_grid(case):
    """Returns options that divide the cells of a case in every direction by the same power of two, until there are at most
    CELLS_MAX."""
    cells = [int(n) for n in read_options(case).get("grid_cells", "").split(",") if n]
    if not cells:
        return []
    factor, dimension = 1, sum(n > 1 for n in cells)
    while math.prod(cells) / factor ** dimension > CELLS_MAX:
        factor *= 2
    return ["-grid_cells", ",".join(str(max(n // factor, 1)) for n in cells)]


def digest_of(folder):
    """Returns a digest of the state at the end of a run and of its tables; empty if the run did not finish."""
    summary = folder / "summary.json"
    if not summary.exists():
        return ""
    digest = hashlib.sha256(json.loads(summary.read_text())["state_hash"].encode())
    for table in sorted(folder.glob("*.csv")):
        digest.update(f"{table.name}\0{table.read_text()}\0".encode())
    if (folder / "bodies.h5").exists():
        with h5py.File(folder / "bodies.h5") as file:
            file.visititems(lambda name, item: isinstance(item, h5py.Dataset) and digest.update(name.encode() + bytes(item[()].tobytes())))
    return digest.hexdigest()


def short_run(program, case, method):
    """Returns the digest of a run on a coarse grid, or on the grid of the case if that is refused (inlet profiles); empty if both are
    refused, as membranes are with classic."""
    for grid in coarse_grid(case), []:
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([program, case, "-method", method, *grid, *OPTIONS, "-output_dir", folder, "-output_overwrite"],
                           capture_output=True, cwd=ROOT)
            found = digest_of(pathlib.Path(folder))
        if found:
            return found
    return ""


def results(program=None, cases=None):
    """Runs a few steps of every case (files; those of options/ if None) with both methods on coarse grids, two runs at once, and
    returns a short hash of all states and tables. Takes a minute or two."""
    program = str(program or os.environ.get("EULASTIC", ROOT / "build/release/eulastic"))
    runs = [(case, method) for case in cases or sorted((ROOT / "options").glob("*.opts")) for method in ("fast", "classic")]
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        found = pool.map(lambda run: f"{run[0].stem} {run[1]} {short_run(program, *run)}\n", runs)
        return hashlib.sha256("".join(found).encode()).hexdigest()[:8]
