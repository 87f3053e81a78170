"""scripts/dev/mutate: which mutations it chooses, and how it applies them. Builds nothing."""
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts/lib"))
sys.dont_write_bytecode = True
from load_script import load  # noqa: E402

mutate = load("dev/mutate")
SOURCES = {str(path.relative_to(ROOT)): path.read_text() for path in ROOT.glob("src/**/*.[ch]pp")}
EXAMPLE = '''// A comment: a - b < c.
#include "base/a+b.hpp"
#define DOUBLE(x) (x + x)
namespace eulastic {
/* if (a < b)
   return a - b; */
constexpr double growth = 0.5;
constexpr double flops = 8;
template <int Dim, class Law = std::array<int, 3>>
struct Point {
  int rows = 2;
  void move(double dt);
};
PetscErrorCode step(const Box &box, double *q) {
  PetscFunctionBeginUser;
  PetscLogFlops(2 * 3);
  const std::string name = "a - b" + text;
  if (q[0] < 0) SETERRQ(PETSC_COMM_SELF, 1, "q < 0 is - not - allowed");
  std::vector<std::pair<int, double>> pairs;
%s
  PetscFunctionReturn(0);
}
}  // namespace eulastic
'''


def mutations(line):
    """{(kind, mutated line)} of a line in the body of a function; nothing else of EXAMPLE may change but constants."""
    found = [mutation for each in mutate.candidates({"src/base/a.cpp": EXAMPLE % ("  " + line)}).values() for mutation in each]
    return {(mutation["kind"], mutation["after"].strip()) for mutation in found if mutation["before"].strip() == line}


class Candidates(unittest.TestCase):
    def assert_among(self, line, *expected):
        self.assertLessEqual(set(expected), mutations(line))

    def test_signs(self):
        self.assertEqual(mutations("x += a - b;"), {
            ("sign", "x -= a - b;"), ("sign", "x += a + b;"), ("statement", ";")})
        self.assert_among("y = f(-b, x);", ("sign", "y = f(b, x);"))
        self.assertNotIn("sign", {kind for kind, _ in mutations('name = other + "x";')})

    def test_bounds(self):
        self.assert_among("for (int i = 0; i < n - 1; ++i) {", *(("bound", f"for (int i = {loop}; ++i) {{") for loop in (
            "0; i <= n - 1", "1; i < n - 1", "0; i < n")))
        self.assert_among("for (int i = 0; i < n; ++i) {", ("bound", "for (int i = 0; i < n - 1; ++i) {"))
        self.assert_among("const bool more = a >= b;", ("bound", "const bool more = a > b;"))

    def test_indices(self):
        self.assert_among("p = q[i + 1];", ("index", "p = q[i];"))
        self.assert_among("p = q[0] - q[1];", ("index", "p = q[1] - q[1];"), ("index", "p = q[0] - q[0];"))
        self.assert_among("p = view(i, j, k);", ("index", "p = view(i, k, j);"))
        self.assertEqual(mutations("double g[1];"), set())

    def test_exchanges(self):
        for line in ("PetscCall(exchange_->update_ghosts(divergence, 1));", "fill_ghosts_of_increment(grid, q, 1);",
                     "PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, x, n, MPI_INT, MPI_MAX, comm));"):
            self.assert_among(line, ("exchange", ";"))
        self.assert_among("if (open) wrap_rows(wanted);", ("exchange", "if (open) ;"))

    def test_orders(self):
        self.assert_among("const double x = a + b * d + c;", ("order", "const double x = a + (b * d + c);"))
        self.assert_among("return (a + b) + c;", ("order", "return a + (b + c);"))
        self.assert_among("x = a * b * c;", ("order", "x = a * (b * c);"))
        self.assert_among("for (int d = 0; d < dim; ++d) sum += x[d];", ("order", "for (int d = dim - 1; d >= 0; --d) sum += x[d];"))
        for line in ("const int x = a + b + c;", "x = d - (a + b) + c;", "for (int d = 0; d < dim; ++d) y[d] += x[d];"):
            self.assertNotIn("order", {kind for kind, _ in mutations(line)}, line)

    def test_conditions(self):
        self.assert_among("if (a < b && c) {", ("condition", "if (!(a < b && c)) {"))
        self.assert_among("if (!found) {", ("condition", "if (found) {"))
        self.assert_among("if (const int n = size(); n == 0) {", ("condition", "if (const int n = size(); !(n == 0)) {"),
                          ("condition", "if (const int n = size(); n != 0) {"))
        self.assert_among("x = high ? a : b;", ("condition", "x = !high ? a : b;"))

    def test_constants(self):
        self.assert_among("x = 0.5 * y;", ("constant", "x = 0.25 * y;"))
        self.assert_among("x = std::min(y, 2);", ("constant", "x = std::min(y, 3);"))
        self.assertNotIn("constant", {kind for kind, _ in mutations("x = static_cast<Array<int, 2>>(y);")})

    def test_statements(self):
        self.assert_among("clear();", ("statement", ";"))
        self.assert_among("if (empty) continue;", ("statement", "if (empty) ;"))
        for line in ("double x = y;", "const Point<3> &p = q;", "Point p(x);", "return;", "VerbScope scope(Verb::wait);"):
            self.assertEqual({kind for kind, _ in mutations(line)} & {"statement"}, set(), line)

    def test_only_code_changes(self):
        found = [mutation for each in mutate.candidates({"a.cpp": EXAMPLE % "  ;"}).values() for mutation in each]
        self.assertEqual({(mutation["before"].strip(), mutation["after"].strip()) for mutation in found}, {
            ("constexpr double growth = 0.5;", "constexpr double growth = 0.25;"), ("int rows = 2;", "int rows = 3;")})


class Choice(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.chosen = [mutate.choose(SOURCES, 30, seed) for seed in (1, 2)]
        cls.all = [mutation for chosen in cls.chosen for mutations in chosen for mutation in mutations]

    def test_the_seed_decides(self):
        some = {file: text for file, text in SOURCES.items() if file.startswith(("src/grid/", "src/field/"))}
        self.assertEqual(mutate.choose(some, 20, 1), mutate.choose(dict(reversed(some.items())), 20, 1))
        self.assertNotEqual(mutate.choose(some, 20, 1), mutate.choose(some, 20, 2))

    def test_every_folder_and_every_kind(self):
        folders = {file.rpartition("/")[0] for file in SOURCES}
        for chosen in self.chosen:
            self.assertEqual([mutations[0]["number"] for mutations in chosen], list(range(1, 31)))
            self.assertEqual({mutations[0]["file"].rpartition("/")[0] for mutations in chosen}, folders)
            places = [(mutations[0]["file"], mutations[0]["line"], mutations[0]["after"]) for mutations in chosen]
            self.assertEqual(len(set(places)), 30)
        self.assertEqual({mutations[0]["kind"] for chosen in self.chosen for mutations in chosen}, set(mutate.KINDS))

    def test_larger_folders_get_more(self):
        files = [mutations[0]["file"].split("/")[1] for mutations in self.chosen[0]]
        self.assertEqual(files.count("base"), 1)
        self.assertGreater(min(files.count("membranes"), files.count("scene")), 1)

    def test_one_line_changes_and_it_is_code(self):
        for mutation in self.all:
            with self.subTest(mutation=mutate.describe(mutation)):
                text = SOURCES[mutation["file"]]
                before, after = text.split("\n"), mutate.apply(mutation, text).split("\n")
                self.assertEqual([number for number, (one, two) in enumerate(zip(before, after), 1) if one != two],
                                 [mutation["line"]])
                self.assertEqual(len(before), len(after))
                begin = sum(len(line) + 1 for line in before[:mutation["line"] - 1])
                start, end = mutation["span"]
                code = mutate.mask(text)[0]
                self.assertNotEqual(code[begin + start:begin + end].strip(), "")
                self.assertIsNone(re.match(r"\s*(#|//|\* |using |template )", mutation["before"]))

    def test_replacements_are_of_the_same_kind_and_folder(self):
        for mutations in self.chosen[0]:
            first = mutations[0]
            self.assertEqual({(mutation["number"], mutation["file"].rpartition("/")[0]) for mutation in mutations},
                             {(first["number"], first["file"].rpartition("/")[0])})
            self.assertEqual(len({mutation["kind"] for mutation in mutations[1:]}), 1)  # another one if there is no second
            self.assertNotIn(first, mutations[1:])

    def test_another_tree(self):
        """Lines are found by their text; not if there are more or fewer of them."""
        text = "x = 1;\ny = 2;\nx = 1;\n"
        mutation = {"before": "x = 1;", "after": "x = 2;", "copy": 1, "copies": 2, "line": 3}
        self.assertEqual(mutate.apply(mutation, "\n" + text), "\nx = 1;\ny = 2;\nx = 2;\n")
        self.assertIsNone(mutate.apply(mutation, text + "x = 1;\n"))
        self.assertIsNone(mutate.apply(mutation, ""))


if __name__ == "__main__":
    unittest.main()
