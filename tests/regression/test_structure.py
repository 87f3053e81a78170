"""The house rules that a machine can check: include arrows, file sizes, headers of cases, scripts, paths, links."""
import os
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
LEVELS = [{"base"}, {"grid"}, {"kernels"}, {"field"}, {"bodies", "io", "pressure"}, {"parts"}, {"solids", "rigid"},
          {"drops"}, {"membranes"}, {"flow"}, {"boxes", "diagnostics"}, {"adhesion", "openings"}, {"solver"}, {"scene"}, {"options"},
          {"output"}, {"run"}]
LEVEL = {room: level for level, rooms in enumerate(LEVELS) for room in rooms}
ROOMS = ["src", "tests", "options", "scripts", "python", "packaging", "docs", "tools", "cmake", ".ci", ".github"]
LINES_MAX, FUNCTION_LINES_MAX, REACH_MAX = 600, 60, 40


def files(*rooms):
    found = [path for room in rooms for path in sorted((ROOT / room).rglob("*")) if path.is_file()]
    return [path for path in found if "__pycache__" not in path.parts]


def text_files():
    tops = [path for suffix in ("md", "txt", "json", "cff") for path in sorted(ROOT.glob("*." + suffix))]
    return [path for path in tops + files(*ROOMS) if path.suffix not in (".png", ".svg", ".h5", ".stl", ".nrrd")]


def includes(path):
    return re.findall(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', path.read_text(), re.MULTILINE)


def may_include(room, other):
    return room == other or LEVEL[other] < LEVEL[room]


def long_functions(text):
    """Lines of functions at the margin that have more than FUNCTION_LINES_MAX, by the line where they begin."""
    found, start = {}, None
    for line, words in enumerate(text.split("\n"), 1):
        if words.endswith("{") and re.match(r"[A-Za-z]", words) and not re.match(r"(namespace|class|struct|enum|union)\b", words):
            start = line
        if words == "}" and start:
            if line - start > FUNCTION_LINES_MAX:
                found[start] = line - start
            start = None
    return found


def name(path):
    return str(path.relative_to(ROOT))


class Structure(unittest.TestCase):
    def test_arrows_of_the_rule_itself(self):
        self.assertTrue(may_include("run", "base") and may_include("solids", "field") and may_include("io", "io"))
        for pair in (("drops", "membranes"), ("kernels", "field"), ("solids", "membranes"), ("io", "solver")):
            self.assertFalse(may_include(*pair), pair)

    def test_folders_are_known(self):
        self.assertEqual({path.name for path in (ROOT / "src").iterdir()} - set(LEVEL), set())

    def test_unit_tests_lie_in_the_folders_of_src(self):
        found = [path.relative_to(ROOT / "tests/unit") for path in files("tests/unit")]
        self.assertTrue(found)
        self.assertEqual([str(path) for path in found if len(path.parts) != 2 or path.parts[0] not in LEVEL], [])

    def test_includes_point_one_way(self):
        wrong = []
        for path in files("src"):
            room = path.relative_to(ROOT / "src").parts[0]
            for target in includes(path):
                other = target.split("/")[0]
                if "/" in target and other in LEVEL and not may_include(room, other):
                    wrong.append(f"{name(path)} includes {target}")
        self.assertEqual(wrong, [])

    def test_own_includes_exist_and_name_their_folder(self):
        wrong = []
        for path in files("src"):
            quoted = re.findall(r'^\s*#\s*include\s*"([^"]+)"', path.read_text(), re.MULTILINE)
            wrong += [f"{name(path)} includes {target}" for target in quoted if not (ROOT / "src" / target).is_file()]
        self.assertEqual(wrong, [])

    def test_kernels_are_free_of_petsc(self):
        kernels = files("src/kernels")
        self.assertTrue(kernels)
        wrong = []
        for path in kernels + [ROOT / "src/grid/segment.hpp"]:
            for target in includes(path):
                own = "/" in target and target.split("/")[0] in LEVEL
                plain = target.startswith("kernels/") or target == "grid/segment.hpp"
                if target.startswith(("petsc", "mpi")) or own and not plain:
                    wrong.append(f"{name(path)} includes {target}")
        self.assertEqual(wrong, [])

    def test_a_box_knows_neither_petsc_nor_ranks(self):
        reached, todo = set(), ["grid/box.hpp", "grid/threads.hpp", "grid/row_scratch.hpp", "field/field.hpp"]
        while todo:
            target = todo.pop()
            if target not in reached and (ROOT / "src" / target).is_file():
                todo += includes(ROOT / "src" / target)
            reached.add(target)
        self.assertIn("grid/segment.hpp", reached)
        wrong = [target for target in reached if target.startswith(("petsc", "mpi")) or target in ("grid/domain.hpp", "grid/split.hpp")]
        self.assertEqual(wrong, [])

    def test_files_are_short(self):
        counts = {name(path): path.read_text().count("\n") for path in files("src", "tests", "scripts", "python", "tools")
                  if path.suffix != ".csv"}
        self.assertTrue(counts)
        self.assertEqual({path: lines for path, lines in counts.items() if lines > LINES_MAX}, {})

    def test_functions_are_short(self):
        self.assertEqual(long_functions("int f() {\n" + "  ++n;\n" * 60 + "}\n"), {1: 61})
        long = {f"{name(path)}:{line}": lines for path in files("src") if path.suffix in (".cpp", ".hpp")
                for line, lines in long_functions(path.read_text()).items()}
        self.assertEqual(long, {})

    def test_headers_of_the_step_reach_few_others(self):
        headers = {name(path)[len("src/"):]: includes(path) for path in files("src") if path.suffix == ".hpp"}
        for header in (header for header in headers if header.startswith(("solver/", "parts/"))):
            reached, todo = set(), list(headers[header])
            while todo:
                target = todo.pop()
                if target in headers and target not in reached:
                    reached.add(target)
                    todo += headers[target]
            self.assertLessEqual(len(reached), REACH_MAX, header)

    def test_sources_begin_with_what_they_are(self):
        headers = [path for path in files("src") if path.suffix == ".hpp"]
        self.assertEqual([name(path) for path in headers if not path.read_text().startswith("// ")], [])
        self.assertEqual([name(path) for path in headers if "#pragma once" not in path.read_text()], [])

    def test_cases_say_what_they_show(self):
        cases = sorted((ROOT / "options").glob("*.opts"))
        self.assertTrue(cases)
        self.assertEqual([name(path) for path in cases if not re.match(r"# \w.{20,}\n#", path.read_text())], [])

    def test_scripts_can_be_started(self):
        for path in files("scripts", ".ci"):
            with self.subTest(script=name(path)):
                if path.name == "environment" or path.suffix == ".py":  # modules
                    self.assertFalse(os.access(path, os.X_OK))
                    continue
                self.assertTrue(os.access(path, os.X_OK))
                self.assertIn(path.read_text().splitlines()[0], ("#!/bin/bash", "#!/usr/bin/python3", "#!/usr/bin/python3 -B"))

    def test_no_path_of_one_machine(self):
        private = re.compile(r"(?<![\w.}])/(%s)/" % "|".join(["home", "root", "work", "Users", "mnt"]))
        self.assertTrue(private.search("see /" + "home/me"))
        wrong = [f"{name(path)}: {line.strip()}" for path in text_files()
                 for line in path.read_text(errors="replace").splitlines() if private.search(line)]
        self.assertEqual(wrong, [])

    def test_links_lead_somewhere(self):
        pages = [path for path in [*ROOT.glob("*.md"), *files("docs")] if path.suffix == ".md"]
        self.assertIn(ROOT / "README.md", pages)
        wrong = []
        for path in pages:
            for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", path.read_text()):
                if "://" not in target and not (path.parent / target).exists():
                    wrong.append(f"{name(path)}: {target}")
        self.assertEqual(wrong, [])


if __name__ == "__main__":
    unittest.main()
