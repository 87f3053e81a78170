"""Options, labels with units, and error messages that the scripts for pictures share."""
import argparse
import contextlib
import pathlib
import re
import sys

from .reading import Run


def open_run(directory):
    """Returns the Run in a directory. If there is none, the script ends with one line."""
    try:
        return Run(directory)
    except FileNotFoundError as error:
        sys.exit(f"{pathlib.Path(sys.argv[0]).name}: {error}")


@contextlib.contextmanager
def refusing_to_write(path):
    """Ends the script with one line where a file, this one if the error names none, cannot be written."""
    try:
        yield
    except OSError as error:
        reason = f"{error.filename or path} cannot be written: {error.strerror}" if error.strerror else error
        sys.exit(f"{pathlib.Path(sys.argv[0]).name}: {reason}; accepted: a place where you may write and with free space")


def of_column(name):
    """Returns the quantity of a column of series.csv; None for a pure number."""
    if name == "time" or name == "dt" or name.startswith("dt_"):
        return "time"
    if "drift" in name or name.startswith("divergence"):
        return None
    words = {"_energy": "energy", "energy_": "energy", "_power": "power", "dissipation": "power", "flow_rate": "flow rate",
             "apparent_viscosity": "viscosity", "pressure": "pressure", "velocity": "velocity", "speed": "velocity",
             "volume": "volume"}
    return next((quantity for word, quantity in words.items() if word in name), None)


class Units:
    """Names of units for labels, and factors from the units of the run to them; the solver itself accepts any consistent set of
    units. For um, us and pg the labels are µm/ms, Pa, mPa s, fJ and nW."""

    def __init__(self, text):
        words = text.split(",") if text else ["", "", ""]
        if len(words) not in (2, 3) or text and not all(words):
            raise ValueError(text)
        self.length, self.time, self.mass = (*words, "")[:3]
        self.set_dimension(3)

    def set_dimension(self, d):
        """Sets the dimension: 3, or 2, where integrals are per depth."""
        length, time, mass, power = self.length, self.time, self.mass, dict(zip(range(2, 6), "²³⁴⁵"))
        self.names, self.factors = {}, {}
        if not length:
            return
        self.names = {"length": length, "time": time, "velocity": f"{length}/{time}", "rate": f"1/{time}",
                      "volume": length + power[d], "flow rate": f"{length}{power[d]}/{time}"}
        if [name.replace("u", "µ") for name in (length, time, mass)] == ["µm", "µs", "pg"]:
            depth = "" if d == 3 else f"/{length}"
            self.names.update({"velocity": f"{length}/{time.replace('µ', 'm').replace('u', 'm')}", "pressure": "Pa",
                               "viscosity": "mPa s", "energy": "fJ" + depth, "power": "nW" + depth,
                               "force": "pN" + depth})
            self.factors = {"velocity": 1e3, "pressure": 1e3, "force": 1e3}
        elif mass:
            force = f"{mass} {length}" if d == 3 else mass
            self.names.update({"pressure": f"{mass}/({length} {time}²)", "viscosity": f"{mass}/({length} {time})",
                               "energy": f"{force}{'²' if d == 3 else f' {length}'}/{time}²",
                               "power": f"{force}{'²' if d == 3 else f' {length}'}/{time}³", "force": f"{force}/{time}²"})
        else:
            self.names.update({"pressure": f"ρ {length}²/{time}²", "viscosity": f"ρ {length}²/{time}",
                               "energy": f"ρ {length}{power[d + 2]}/{time}²", "power": f"ρ {length}{power[d + 2]}/{time}³",
                               "force": f"ρ {length}{power[d + 1]}/{time}²"})

    def factor(self, quantity):
        """Returns the factor by which values of the run are multiplied for labels of this quantity."""
        return self.factors.get(quantity, 1)

    def label(self, words, quantity):
        return f"{words} ({self.names[quantity]})" if quantity in self.names else words

    def after(self, quantity):
        return " " + self.names[quantity] if quantity in self.names else ""

    def at(self, time):
        """Returns the text for a time: four digits, or all digits before the decimal point if there are more."""
        return f"t = {time:.4g}{self.after('time')}" if abs(time) < 1e4 else f"t = {time:.0f}{self.after('time')}"

    @staticmethod
    def add_option(parser):
        parser.add_argument("--units", type=Units, default="µm,µs,pg", metavar="LENGTH,TIME[,MASS]",
                            help='of the run, for labels (default "µm,µs,pg": velocities are shown in µm/ms, stresses in Pa; "" for none)')


class Parser(argparse.ArgumentParser):
    """Accepts -30,20 as a value instead of an option."""

    def __init__(self, *words, **keywords):
        super().__init__(*words, **keywords)
        self._negative_number_matcher = re.compile(r"^-\.?\d[-+.,\deE]*$")
