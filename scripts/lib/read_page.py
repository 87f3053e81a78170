"""Reads the commands, files and Python programs in the pages of docs/: for scripts/dev/tutorial and the tests."""
import re

PROGRAMS = ("scripts/", "build/release/eulastic", "mpiexec", "eulastic ", "eulastic-", "cmake", "git", ".ci/", "sbatch", "srun", "for ", "EULASTIC_MPIEXEC=")


def blocks(page):
    """Yields indented or fenced blocks of a page, each with the words that end the line before it."""
    block, before, fenced = [], "", False
    lines = page.read_text().splitlines() + ["end"]
    for n, line in enumerate(lines):
        fence = line.startswith("```")
        fenced ^= fence
        indented = line.startswith("    ") or not line and any(x for x in lines[n:]) and \
            next(x for x in lines[n:] if x).startswith("    ")
        if not fence and (fenced or block and indented or line.startswith("    ")):
            block.append(line if fenced else line[4:])
        elif block:
            yield before, block
            block = []
        if line and not fence and not block:
            before = line


def file_name(before):
    """Returns the name of the file that a block contains, if "... NAME.opts:" or "... NAME.csv:" precedes it; otherwise None."""
    found = re.search(r"\b(\w+\.(opts|csv)):$", before)
    return found[1] if found else None


def is_python(block):
    return block[0].startswith(("from ", "import "))


def commands(block):
    """Returns the commands of a block without comments, with continued lines joined; nothing if it is not shell."""
    if is_python(block):
        return []
    text = re.sub(r"\\\n\s*", "", "\n".join(block))
    found = [re.sub(r"\s+#.*", "", line).strip() for line in text.splitlines()]
    return [line for line in found if line.startswith(PROGRAMS) and not re.search(r"\[|\bDIRECTORY\b|\bCASE\b", line)]
