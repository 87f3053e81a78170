"""Runs of the benchmark program, and tables between the marks of docs/performance.md.

    rows = run_benchmarks("^step/", ranks=2, repetitions=5)
    write_tables({"name": markdown_table([{"case": "a"}], {"case": "case"})})
"""
import json
import os
import pathlib
import re
import shlex
import shutil
import statistics
import subprocess
import sys
import tempfile

import program_environment  # noqa: F401

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs/performance.md"
# Ranks stay on their cores while they are timed.
ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "OMPI_MCA_hwloc_base_binding_policy"}


def say(text):
    print(text, file=sys.stderr, flush=True)


def build(preset, *targets):
    subprocess.run([ROOT / "scripts/build", preset, *targets], check=True, stdout=sys.stderr)
    return ROOT / "build" / preset


def on_ranks(ranks, command):
    """Returns the command line that starts `command` on this number of ranks."""
    launcher = shlex.split(os.environ.get("EULASTIC_MPIEXEC", shutil.which("mpiexec") or "mpiexec"))
    return [str(word) for word in ([*launcher, "-n", ranks] if ranks > 1 else []) + list(command)]


def run_benchmarks(program, pattern, ranks=1, repetitions=5, more=(), threads=1):
    """Runs benchmarks. Returns {benchmark: {counter: median of the repetitions}}; peak (Gflop/s) and triad (GB/s) of all cores are
    counters."""
    with tempfile.NamedTemporaryFile(suffix=".json") as file:
        command = [program, f"--threads={threads}", f"--benchmark_filter={pattern}", f"--benchmark_repetitions={repetitions}",
                   f"--benchmark_out={file.name}", "--benchmark_out_format=json", "--benchmark_color=false", *more]
        done = subprocess.run(on_ranks(ranks, command), stdout=sys.stderr, env=ENVIRONMENT)
        if done.returncode:
            sys.exit(f"{program.name}: exit status {done.returncode} on {ranks} ranks")
        result = json.load(open(file.name))
    gathered = {}
    for run in result["benchmarks"]:
        if run.get("error_occurred"):
            sys.exit(f"{program.name}: {run['name']}: {run['error_message']}")
        if run.get("run_type") != "aggregate":
            name = re.sub(r"/(iterations:\d+|real_time)", "", run["run_name"])
            gathered.setdefault(name, []).append(run)
    return {name: {key: statistics.median(run[key] for run in runs) for key, value in runs[0].items()
                      if isinstance(value, (int, float))} for name, runs in gathered.items()}


def median_of(runs, counter):
    return statistics.median(run[counter] for run in runs.values())


def markdown_table(rows, columns):
    """Returns a Markdown table. `columns`: {key of the rows: title}."""
    lines = ["| " + " | ".join(columns.values()) + " |", "|" + "---|" * len(columns)]
    lines += ["| " + " | ".join(str(row[name]) for name in columns) + " |" for row in rows]
    return "\n".join(lines)


def write_tables(tables, path=None, made=None):
    """Writes every text between <!-- table NAME --> and <!-- end --> in docs/performance.md, or in the page `path`, and below it the
    sentence `made` of measured.made_with(), which the caller creates before anything is written."""
    path = path or PAGE
    page = path.read_text()
    for name, text in tables.items():
        if made:
            text += f"\n\n{made}"
        page, count = re.subn(rf"<!-- table {name} -->.*?<!-- end -->",
                              lambda _: f"<!-- table {name} -->\n{text}\n<!-- end -->", page, flags=re.S)
        if count != 1:
            sys.exit(f"{path}: no place for the table {name}")
    path.write_text(page)
