"""Files of options, read by the rules of the program (src/options/option_source.cpp)."""
import pathlib

DEPTH_MAX = 8  # of files that bring in others
BLANKS = " \t\n\v\f\r"


def is_name(word):
    """Returns whether a word is the name of an option; -1, -.5, -inf and -nan are values."""
    start = word[1:].split(",")[0].lower()
    return word[:1] == "-" and len(word) > 1 and not (word[1].isdigit() or word[1] == ".") and \
        start not in ("inf", "infinity", "nan")


def split_words(line):
    """Splits a line at blanks. Quotes keep blanks and # in a word, and in them \\" is a quote and \\\\ a backslash; otherwise #
    begins a comment. ValueError if a quote stays open."""
    words, inside, quoted, escaped = [], False, False, False
    for at, c in enumerate(line):
        if not quoted and c in BLANKS:
            inside = False
            continue
        if not inside:
            if c == "#":
                break
            words.append("")
        inside = True
        if escaped:
            words[-1], escaped = words[-1] + c, False
        elif quoted and c == "\\" and line[at + 1:at + 2] in ('"', "\\"):
            escaped = True
        elif c == '"':
            quoted = not quoted
        else:
            words[-1] += c
    if quoted:
        raise ValueError("a quote is not closed")
    return words


def pairs(words):
    """Returns [(name without dash, value)] for words that alternate; the value of a name without one is "". ValueError for a
    value without a name."""
    found, name = [], None
    for word in words:
        if is_name(word):
            name = word[1:]
            found.append((name, ""))
        elif name is not None:
            found[-1] = name, word
            name = None
        else:
            raise ValueError(f'stray word "{word}"')
    return found


def parse_options(words):
    """Returns options as {name without dash: value}."""
    return dict(pairs(words))


def read_options(path, depth=0):
    """Returns {name without dash: value} of a file of options: lines `-name value`, in which # begins a comment and quotes keep
    blanks. -options_file includes another file, relative to the directory of this one; options of this file override those of the
    other. Bytes that are no UTF-8 are kept as Python keeps them in paths. ValueError names the file and the line that the program
    would refuse, too."""
    path, own, brought_in = pathlib.Path(path), {}, {}
    if depth > DEPTH_MAX:
        raise ValueError(f"-options_file: {path} includes itself")
    for number, line in enumerate(path.read_bytes().decode("utf-8", "surrogateescape").split("\n"), 1):
        try:
            found = pairs(split_words(line))
        except ValueError as error:
            raise ValueError(f"{error} ({path}:{number})") from None
        if found and found[-1][0] == "options_file":
            brought_in.update(read_options(path.parent / found.pop()[1], depth + 1))
        own.update(found)
    return {**brought_in, **own}
