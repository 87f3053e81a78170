"""Writes the line of a page of evidence that names the program, the date, the machine and the script with which it was made."""
import datetime
import hashlib
import os
import pathlib
import re
import subprocess
import sys

import program_environment  # noqa: F401

ROOT = pathlib.Path(__file__).resolve().parents[2]
LINE = re.compile(r"^> Made with eulastic .*\n", re.M)


def digits(value, number=2):
    """Returns the value with this number of significant digits, large ones without an exponent: 1100, not 1.1e+03."""
    return f"{float(f'{value:.{number}g}'):g}"


def machine():
    try:
        info = pathlib.Path("/proc/cpuinfo").read_text()
    except OSError:
        info = ""
    name = re.search(r"^model name\s*: (.*)$", info, re.M)
    wide = " with AVX-512" if " avx512f" in info else ""
    return f"{os.cpu_count()} cores of {name[1] if name else 'an unknown processor'}{wide}"


TEXT_OR_COMMENT = re.compile(r''''(?:\\.|[^'\\\n])'|R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"|//[^\n]*|/\*(?:.|\n)*?\*/''')


def code_of(text):
    """Returns C++ code without comments and with single blanks; string literals are kept."""
    code = TEXT_OR_COMMENT.sub(lambda found: " " if found[0].startswith("/") else found[0], text)
    return " ".join(code.split())


def sources(folder=None):
    """Returns a short hash of the code in all files below `folder` (default src/). It identifies the program that made a number,
    whatever docs, scripts and comments say."""
    folder = pathlib.Path(folder or ROOT / "src")
    digest = hashlib.sha256()
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        digest.update(f"{path.relative_to(folder)}\0{code_of(path.read_text())}\0".encode())
    return digest.hexdigest()[:8]


def version(program=None):
    """Returns the program's own version, such as 1.0.0; ? if it cannot be run."""
    says = subprocess.run([program or os.environ.get("EULASTIC", ROOT / "build/release/eulastic"), "-version"], capture_output=True,
                          text=True).stdout
    found = re.search(r"eulastic ([\d.]+)", says)
    return found[1] if found else "?"


def made_with(program=None):
    """Returns the sentence that names the program, the date, the machine and the script."""
    script = pathlib.Path(sys.argv[0]).resolve()
    return (f"Made with eulastic {version(program)} (sources {sources()}), {datetime.date.today()}, on {machine()}, by "
            f"`{script.relative_to(ROOT)}`.")


def stamp(path, program=None):
    """Writes this line below the title of the page `path`, in place of the present one."""
    line = f"> {made_with(program)}\n"
    title, _, rest = LINE.sub("", path.read_text()).partition("\n")
    path.write_text(f"{title}\n\n{line}\n{rest.lstrip()}")
