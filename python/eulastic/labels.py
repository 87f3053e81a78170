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


def of_column(name):
    """The quantity that a column of series.csv is; None of a plain number."""
    if name == "time" or name == "dt" or name.startswith("dt_"):
        return "time"
    if "drift" in name or name.startswith("divergence"):
        return None
    words = {"_energy": "energy", "energy_": "energy", "_power": "power", "dissipation": "power", "flow_rate": "flow rate",
             "apparent_viscosity": "viscosity", "pressure": "pressure", "velocity": "velocity", "speed": "velocity",
             "volume": "volume"}
    return next((quantity for word, quantity in words.items() if word in name), None)


class Units:
    """Names of units for labels; the solver itself takes any consistent set."""

    def __init__(self, text):
        self.length, self.time = text.split(",") if text else ("", "")
        self.set_dimension(3)

    def set_dimension(self, d):
        """3, or 2, where integrals are per depth."""
        length, time, power = self.length, self.time, dict(zip(range(2, 6), "²³⁴⁵"))
        self.names = {"length": length, "time": time, "velocity": f"{length}/{time}", "rate": f"1/{time}",
                      "pressure": f"ρ {length}²/{time}²", "viscosity": f"ρ {length}²/{time}", "volume": length + power[d],
                      "energy": f"ρ {length}{power[d + 2]}/{time}²", "power": f"ρ {length}{power[d + 2]}/{time}³",
                      "flow rate": f"{length}{power[d]}/{time}"} if length else {}

    def label(self, words, quantity):
        return f"{words} ({self.names[quantity]})" if quantity in self.names else words

    def after(self, quantity):
        return " " + self.names[quantity] if quantity in self.names else ""

    def at(self, time):
        """Words for a moment: four digits, and all of those before the point."""
        return f"t = {time:.4g}{self.after('time')}" if abs(time) < 1e4 else f"t = {time:.0f}{self.after('time')}"

    @staticmethod
    def add_option(parser):
        parser.add_argument("--units", type=Units, default="µm,µs", metavar="LENGTH,TIME",
                            help='for labels (default "µm,µs"; "" for none)')
