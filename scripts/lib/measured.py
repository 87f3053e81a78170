"""Pages of evidence say once with which program, when and on what machine they were made, and by which script."""
import datetime
import os
import pathlib
import re
import subprocess
import sys

import program_environment  # noqa: F401

ROOT = pathlib.Path(__file__).resolve().parents[2]
LINE = re.compile(r"^> Made with eulastic .*\n", re.M)


def machine():
    try:
        info = pathlib.Path("/proc/cpuinfo").read_text()
    except OSError:
        info = ""
    name = re.search(r"^model name\s*: (.*)$", info, re.M)
    wide = " with AVX-512" if " avx512f" in info else ""
    return f"{os.cpu_count()} cores of {name[1] if name else 'an unknown processor'}{wide}"


def git(*words):
    return subprocess.run(["git", "-C", ROOT, *words], capture_output=True, text=True).stdout.strip()


def made_with(program=None):
    """The sentence: with which program, when, where and by which script."""
    program = program or os.environ.get("EULASTIC", ROOT / "build/release/eulastic")
    says = subprocess.run([program, "-version"], capture_output=True, text=True).stdout
    version = re.search(r"eulastic ([\d.]+)", says)
    commit = git("rev-parse", "--short", "HEAD")
    commit += "-dirty" if commit and git("diff", "--name-only", "HEAD", "--", ":!docs") else ""  # the page itself may be new
    script = pathlib.Path(sys.argv[0]).resolve()
    return (f"Made with eulastic {version[1] if version else '?'}{f' ({commit})' if commit else ''}, {datetime.date.today()}, on "
            f"{machine()}, by `{script.relative_to(ROOT)}`.")


def stamp(path, program=None):
    """Puts the line below the title of the page `path`, in place of the one that is there."""
    line = f"> {made_with(program)}\n"
    title, _, rest = LINE.sub("", path.read_text()).partition("\n")
    path.write_text(f"{title}\n\n{line}\n{rest.lstrip()}")
