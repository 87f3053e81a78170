"""Finds numpy and h5py, which the package needs, also among the packages of Debian; otherwise an error says how to install them."""
import importlib
import os
import sys

DEBIAN = "/usr/lib/python3/dist-packages"  # its packages serve any Python of the same version


def not_importable(names):
    """Returns the names that cannot be imported. Modules of a failed import are removed, so that another copy can be tried."""
    failed = []
    for name in names:
        before = set(sys.modules)
        try:
            importlib.import_module(name)
        except (ImportError, AttributeError, ValueError):  # also a compiled module that does not fit the numpy beside it
            failed.append(name)
            for module in set(sys.modules) - before:
                del sys.modules[module]
    return failed


def how_to_install(names):
    """Returns one sentence for the running Python, for conda or pip."""
    if os.path.isdir(os.path.join(sys.prefix, "conda-meta")):
        return f"conda install -p {sys.prefix} {' '.join(names)}"
    return f"{sys.executable} -m pip install {' '.join(names)}"


def find(names=("numpy", "h5py"), debian=DEBIAN):
    """Makes the packages importable; those of the running Python come first. Raises ImportError with the command that installs
    what is missing."""
    failed = not_importable(names)
    if failed and os.path.isdir(debian) and debian not in sys.path:
        sys.path.append(debian)
        failed = not_importable(failed)
        if failed:
            sys.path.remove(debian)
    if failed:
        version = ".".join(map(str, sys.version_info[:2]))
        raise ImportError(f"eulastic needs {' and '.join(failed)}, which Python {version} ({sys.executable}) does not have; "
                          f"install with: {how_to_install(failed)}; or use Debian's: /usr/bin/python3 with python3-h5py")
