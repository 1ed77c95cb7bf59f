"""Names of lines at their ends, right of the axes, in place of a legend."""
from typing import List, Sequence, Tuple

from tandem.label_places import spread


def label_ends(axes, lines: Sequence[Tuple[str, Sequence[float], object]], height: float, size: float = 8.0) -> List[object]:
    """Writes the names of `lines` (name, values, colour) beside the ends of the lines; `height` of the axes [inch]. Returns the texts.

    Call it when all is drawn: it keeps the limits of the axes."""
    import numpy as np
    low, high = axes.get_ylim()
    axes.set_ylim(low, high)
    scale = axes.yaxis.get_transform().transform
    begin, end = scale(np.array([low, high], float))
    wanted, named = [], []
    for name, values, colour in lines:
        values = np.asarray(values, float)
        finite = values[np.isfinite(values)]
        if len(finite) and name:
            wanted.append(float(np.clip((scale(finite[-1:])[0] - begin) / (end - begin), 0, 1)))
            named.append((name, colour))
    step = 1.3 * size / 72 / height  # of the height of the axes
    places = spread(wanted, [step] * len(wanted), -0.5 * step, max(1 + 0.5 * step, (len(wanted) - 0.5) * step))
    texts = []
    for (name, colour), at, place in zip(named, wanted, places):
        axes.plot([1.0, 1.025, 1.04], [at, place, place], transform=axes.transAxes, color=colour, linewidth=0.8, clip_on=False, scalex=False,
                  scaley=False)
        texts.append(axes.text(1.05, place, name, transform=axes.transAxes, color=dark(colour), fontsize=size, va="center", ha="left"))
    return texts


def dark(colour) -> Tuple[float, float, float]:
    """The colour, darkened where letters would be pale on white."""
    from matplotlib.colors import to_rgb
    red, green, blue = to_rgb(colour)
    share = min(1.0, 0.48 / max(0.299 * red + 0.587 * green + 0.114 * blue, 1e-9))
    return share * red, share * green, share * blue
