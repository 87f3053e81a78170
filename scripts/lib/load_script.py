"""Loads scripts, which have no suffix, as modules."""
import importlib.machinery
import importlib.util
import pathlib

SCRIPTS = pathlib.Path(__file__).resolve().parents[1]


def load(script):
    """Returns a script as a module: load("render"), load("studies/paper/paper_figure5"). Arguments of the calling script are
    ignored."""
    loader = importlib.machinery.SourceFileLoader(pathlib.Path(script).name, str(SCRIPTS / script))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module
