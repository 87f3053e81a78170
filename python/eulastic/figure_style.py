"""The look of all figures: 1,600 pixels wide, words that can be read in a column of text, and colours that readers with any
colour vision tell apart (Okabe and Ito, Color Universal Design, 2008). Importing it sets matplotlib up."""
import io

import matplotlib
import numpy

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

WIDTH, DPI = 8, 200  # inches, pixels per inch
SMALL = 8  # points: the least size of words; 22 pixels of 1,600
BLUE, VERMILLION, GREEN, ORANGE, PURPLE, SKY, INK = "#0072B2", "#D55E00", "#009E73", "#E69F00", "#CC79A7", "#56B4E9", "#222222"
COLOURS = BLUE, VERMILLION, GREEN, ORANGE, PURPLE, SKY, INK
DASHES = "-", "--", "-.", ":"
MARKS = "o", "s", "^", "D", "v", "P", "X"
# By method and pressure solver: colour, dashes, mark.
METHODS = {"fast, ACM": (BLUE, "-", "o"), "fast, SMAC": (ORANGE, "--", "s"), "classic, ACM": (VERMILLION, "-.", "^"),
           "classic, SMAC": (PURPLE, ":", "D")}
EXACT = {"color": "0.72", "lw": 5, "solid_capstyle": "butt", "zorder": 0}  # a broad band below the curves
TABLE = {"color": INK, "ls": "none", "marker": "o", "ms": 4.5, "mfc": "white", "mew": 1, "zorder": 5}  # published points

plt.rcParams.update({
    "font.size": 9, "axes.titlesize": 9, "axes.labelsize": 9, "xtick.labelsize": SMALL, "ytick.labelsize": SMALL,
    "legend.fontsize": SMALL, "legend.title_fontsize": SMALL, "legend.frameon": False, "legend.handlelength": 2.6,
    "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "grid.alpha": 0.3, "lines.linewidth": 1.5,
    "axes.prop_cycle": matplotlib.cycler(color=COLOURS), "image.cmap": "viridis", "figure.constrained_layout.use": True,
    "savefig.dpi": DPI, "svg.fonttype": "none"})


def panels(count, columns=3, height=2.5, width=WIDTH, **options):
    """A figure of `count` axes, at most `columns` in a row, each row `height` inches high; the axes as a list."""
    columns = min(columns, count)
    rows = -(-count // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(width, height * rows), squeeze=False, **options)
    for spare in axes.flat[count:]:
        spare.axis("off")
    return figure, list(axes.flat[:count])


def legend_beside(axis, **options):
    """A legend to the right of the axes."""
    return axis.legend(loc="upper left", bbox_to_anchor=(1.01, 1), borderaxespad=0, **options)


def legend_above(axis, columns=2, **options):
    """A legend between the axes and their title."""
    return axis.legend(loc="lower left", bbox_to_anchor=(0, 1), ncol=columns, borderaxespad=0.3, columnspacing=1.2, **options)


def legend_below(figure, axes, columns=4, **options):
    """One legend for all axes, below them: each label once."""
    entries = {}
    for axis in axes:
        for handle, label in zip(*axis.get_legend_handles_labels()):
            entries.setdefault(label, handle)
    entries = dict(sorted(entries.items(), key=lambda entry: entry[0] == "reference"))  # last
    lines = -(-len(entries) // columns) + bool(options.get("title"))
    share = (lines * 1.6 * SMALL + 6) / 72 / figure.get_figheight()
    figure.get_layout_engine().set(rect=(0, share, 1, 1 - share))
    return figure.legend(entries.values(), entries, loc="lower center", ncol=columns, borderaxespad=0.2, columnspacing=1.5, **options)


def least_range(axis, part=1e-3):
    """Curves that move by less than this part of their size are shown at rest: what is left is round-off, no signal."""
    low, high = axis.dataLim.y0, axis.dataLim.y1
    size = max(abs(low), abs(high))
    if axis.get_yscale() == "linear" and high - low < part * size:
        axis.set_ylim((low + high) / 2 - 0.05 * size, (low + high) / 2 + 0.05 * size)


def with_palette(picture, colours):
    """Returns the picture with a palette of this many colours, those of the style among them: of the colours that are frequent alone,
    a grey would replace that of a thin curve."""
    from PIL import Image
    kept = [[round(255 * part) for part in matplotlib.colors.to_rgb(colour)] for colour in (*COLOURS, EXACT["color"], "black", "white")]
    frequent = numpy.reshape(picture.quantize(colours - len(kept)).getpalette()[:3 * (colours - len(kept))], (-1, 3))
    palette = numpy.concatenate([kept, frequent])
    found, where = numpy.unique(numpy.asarray(picture).reshape(-1, 3) @ [1 << 16, 1 << 8, 1], return_inverse=True)
    found = numpy.stack([found >> 16, found >> 8 & 255, found & 255], axis=1)
    nearest = ((found[:, None] - palette) ** 2).sum(axis=2).argmin(axis=1).astype("u1")
    image = Image.fromarray(nearest[where].reshape(picture.height, picture.width), "P")
    image.putpalette(palette.astype("u1").tobytes())
    return image


def save(figure, path, colours=None, **options):
    """A file of the figure, and closes it. `colours`: a PNG of a palette of so many, a quarter of the size; `options` are of
    matplotlib's savefig."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if colours:
        from PIL import Image
        picture = io.BytesIO()
        figure.savefig(picture, format="png", **options)
        with_palette(Image.open(picture).convert("RGB"), colours).save(path, optimize=True)
    else:
        figure.savefig(path, **({"pil_kwargs": {"optimize": True}} if path.suffix == ".png" else {}), **options)
    plt.close(figure)
