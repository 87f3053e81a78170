"""What scripts that draw a run share: labels with units, and one line where there is no run."""
import pathlib
import sys

from .reading import Run


def open_run(directory):
    """The run, for a script: where there is none, the script ends with one line."""
    try:
        return Run(directory)
    except FileNotFoundError as error:
        sys.exit(f"{pathlib.Path(sys.argv[0]).name}: {error}")


class Units:
    """Names of units for labels; the solver itself takes any consistent set."""

    def __init__(self, text):
        length, time = text.split(",") if text else ("", "")
        self.names = {"length": length, "time": time, "velocity": f"{length}/{time}",
                      "pressure": f"ρ {length}²/{time}²", "volume": f"{length}³"} if text else {}

    def label(self, words, quantity):
        return f"{words} ({self.names[quantity]})" if quantity in self.names else words

    def after(self, quantity):
        return " " + self.names[quantity] if quantity in self.names else ""

    @staticmethod
    def add_option(parser):
        parser.add_argument("--units", type=Units, default="µm,µs", metavar="LENGTH,TIME",
                            help='for labels (default "µm,µs"; "" for none)')
