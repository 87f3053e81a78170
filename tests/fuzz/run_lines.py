#!/usr/bin/python3
"""usage: tests/fuzz/run_lines.py FUZZ [N [SEED]]

The first N (300) command lines of the fuzzer (program FUZZ) through the program itself, EULASTIC. A wrong one must give
exit code 2, the line that the parser has for it, nothing else and no file; a right one exit code 0 or an error in one
line. Prints what was tried, refused, accepted and found; exit code 1 if anything was found.
"""
import os
import pathlib
import subprocess
import sys
import tempfile

BINARY = os.environ["EULASTIC"]
SECONDS = 600  # on a busy machine


def cases(fuzz, count, seed):
    """(what should come of it, words) of every line."""
    words = iter(subprocess.run([fuzz, "--lines", str(count), str(seed)], stdout=subprocess.PIPE, check=True).stdout
                 .split(b"\0")[:-1])
    for expected in words:
        yield expected, [next(words) for _ in range(int(next(words)))]


def judge(expected, words):
    """(refused, what is wrong with the program or nothing)"""
    with tempfile.TemporaryDirectory() as room:
        if expected == b"check":
            words = [*words, b"-check_only"]
        try:
            done = subprocess.run([BINARY, *words], cwd=room, capture_output=True, timeout=SECONDS)
        except subprocess.TimeoutExpired:
            return False, "more than ten minutes"
        left = sorted(path.name for path in pathlib.Path(room).rglob("*"))
    lines = [line for line in done.stderr.splitlines() if not line.startswith(b"eulastic: warning: ")]
    if expected not in (b"message", b"run", b"check"):
        if (done.returncode, done.stdout, done.stderr) != (2, b"", b"eulastic: error: " + expected + b"\n"):
            return True, "not refused as it should be"
    if done.returncode not in (0, 1, 2, 3):
        return True, f"exit code {done.returncode}"
    if done.returncode == 2 and left:
        return True, f"refused, but something was written: {left}"
    if done.returncode and (len(lines) != 1 or not lines[0].startswith(b"eulastic: error: ")):
        return True, "an error in not one line"
    if not done.returncode and lines:
        return False, "exit code 0 with an error"
    if any(name.endswith(".tmp") for name in left):
        return False, f"left behind: {left}"
    return done.returncode != 0, ""


def main():
    fuzz, count, seed = (sys.argv[1:] + ["300", "1"][len(sys.argv) - 2:])[:3]
    tried = refused = found = 0
    for expected, words in cases(fuzz, count, seed):
        is_refused, wrong = judge(expected, words)
        tried, refused, found = tried + 1, refused + is_refused, found + bool(wrong)
        if wrong:
            print(f"case {tried - 1}: {wrong}: {words}\nexpected: {expected}", file=sys.stderr)
    print(f"{'input':14} {'tried':>8} {'refused':>8} {'accepted':>8} {'found':>8}")
    print(f"{'the program':14} {tried:8} {refused:8} {tried - refused:8} {found:8}")
    sys.exit(found > 0)


if __name__ == "__main__":
    main()
