"""Draws study.png, error against processor time, with a panel for each measure (docs/study.md)."""
import math
import pathlib
import textwrap
from typing import Dict, List, Optional, Tuple

from tandem.axis_ticks import SUPERSCRIPTS, log_ticks, written
from tandem.end_labels import dark
from tandem.label_places import Box, free_place, place_along, spread
from tandem.plots import GREY, HUES, INK, STYLE
from tandem.study_data import Measure, Row, Study, is_round_off, label_of, read, recommended
from tandem.study_lines import Panel, panel
from tandem.study_words import key_of, sentence_of_round_off

MARKERS = "osD^vP"
SHADES = (0.0, 0.42, -0.35, 0.62, -0.55, 0.25)  # towards white, or black, of the values of a second setting
AMBER = "#b7791f"
DPI = 130
# Sizes in inches: of one panel with its axes' words, of the column of labels per letter, and of lines of words.
PANEL, HEIGHT, LEFT, BELOW, ABOVE, LETTER, BOLD_LETTER, WORDS = 4.5, 3.1, 0.72, 0.62, 0.34, 0.066, 0.074, 0.19


def colour(rank: Tuple[int, int]) -> Tuple[float, ...]:
    from matplotlib.colors import to_rgb
    share = SHADES[rank[1] % len(SHADES)]
    towards = 1.0 if share > 0 else 0.0
    return tuple(part + abs(share) * (towards - part) for part in to_rgb(HUES[rank[0] % len(HUES)]))


def look(rank: Tuple[int, int]) -> Dict[str, object]:
    return {"color": colour(rank), "marker": MARKERS[(rank[1] if rank[1] else rank[0]) % len(MARKERS)]}


class PanelPicture:
    """One panel on its axes. The words get their places when all sizes are known, by place_words()."""

    def __init__(self, axes, study: Study, measure: Measure, shown: Panel, unit: Tuple[float, str]):
        self.axes, self.study, self.measure, self.shown, self.unit = axes, study, measure, shown, unit
        self.guide: List[Tuple[float, float]] = []  # its ends
        self.labels: list = []  # at the line ends, for tests
        self.words: list = []  # inside the panel
        self.best: Optional[Row] = recommended(study, measure)
        axes.set_xscale("log")
        axes.set_yscale("log")
        self._limits()
        self._envelopes()
        self._guide()
        self._floor()
        self._lines()
        self._without_error()
        self._wanted()
        axes.set_title(measure.name.replace("_", " "))
        axes.set_xlabel(f"processor time of the solvers [{unit[1]}]")
        axes.set_ylabel("error" + (f" [{measure.unit}]" if measure.unit not in ("", "-") else ", relative" if measure.unit else ""))

    # ---- what is drawn

    def at(self, row: Row) -> Tuple[float, float]:
        return row.cpu / self.unit[0], row.error(self.measure.name)

    def _rows(self) -> List[Row]:
        return [row for line in self.shown.lines for row in line.rows] + self.shown.others

    def _limits(self) -> None:
        points = [self.at(row) for row in self._rows()]
        ends = [(row.low / self.unit[0], row.high / self.unit[0]) for row in self._rows()]
        errors = [error for _, error in points] + ([self.measure.want] if self.measure.want else [])
        for low, high, below, above, limit, axis in (
                (min(e[0] for e in ends), max(e[1] for e in ends), 0.05, 0.03, self.axes.set_xlim, self.axes.xaxis),
                (min(errors), max(errors), 0.10, 0.14 if self.shown.bad else 0.06, self.axes.set_ylim, self.axes.yaxis)):
            decades = max(math.log10(high / low), 0.3)
            low, high = low / 10**(below * decades), high * 10**(above * decades)
            limit(low, high)
            ticks, minor = log_ticks(low, high)
            axis.set_ticks(ticks, [written(tick) for tick in ticks])
            axis.set_ticks(minor, [""] * len(minor), minor=True)

    def _envelopes(self) -> None:
        for line in self.shown.lines:
            if line.envelope:
                x, y = [time / self.unit[0] for time, _ in line.envelope], [error for _, error in line.envelope]
                self.axes.fill(x, y, facecolor=colour(line.rank), alpha=0.13, edgecolor=colour(line.rank), linewidth=0.8, joinstyle="round",
                               zorder=1)
                self.axes.plot(*zip(*map(self.at, line.rows)), linestyle="none", marker=".", markersize=3.2, markeredgewidth=0,
                               color=colour(line.rank), alpha=0.55, zorder=2)
        if self.shown.others:
            self.axes.plot(*zip(*map(self.at, self.shown.others)), linestyle="none", marker=".", markersize=4, color="#b4bbc2", zorder=1)

    def _lines(self) -> None:
        for line in self.shown.lines:
            x, y = zip(*map(self.at, line.points))
            joined = bool(self.study.line) or bool(line.envelope)
            self.axes.plot(x, y, linestyle="-" if joined else "none", linewidth=1.8, markersize=4.6, markeredgecolor="white",
                           markeredgewidth=0.5, zorder=4, **look(line.rank))
            bars = [(row.cpu - row.low, row.high - row.cpu) for row in line.points]
            if any(low or high for low, high in bars):
                self.axes.errorbar(x, y, xerr=[[part[i] / self.unit[0] for part in bars] for i in (0, 1)], fmt="none",
                                   ecolor=colour(line.rank), elinewidth=1, capsize=2, alpha=0.8, zorder=3)
        suspect = [row for row in self._rows() if row.status == "suspect"]
        if suspect:
            self.axes.plot(*zip(*map(self.at, suspect)), linestyle="none", marker="o", markersize=9, markerfacecolor="none",
                           markeredgecolor=AMBER, markeredgewidth=1.2, zorder=5)

    def _without_error(self) -> None:
        """Crosses at the upper edge, at the time that the run took, or at the left end where that is not on the axis."""
        low = self.axes.get_xlim()[0]
        early = 0
        for row, rank in self.shown.bad:
            shift, x = 0.0, (row.cpu or 0) / self.unit[0]
            if x < low:
                shift, x = 5.0 + 9.0 * early, low
                early += 1
            self.axes.annotate("×", (x, 0.965), xycoords=self.axes.get_xaxis_transform(), xytext=(shift, 0), textcoords="offset points",
                               ha="center", va="center", color=colour(rank), fontsize=12, fontweight="bold", zorder=6, annotation_clip=False)

    def _guide(self) -> None:
        """A line of the order that the methods have, below all points."""
        order = self.shown.order
        if not order:
            return
        points = [self.at(row) for line in self.shown.lines for row in line.points if self.at(row)[1] > 3 * (self.shown.floor or 0)]
        factor = min(error * time**order for time, error in points) / 1.9
        (left, right), (low, high) = self.axes.get_xlim(), self.axes.get_ylim()
        begin = max(left * (right / left)**0.03, (factor / high)**(1 / order))
        end = min(right, (factor / (low * (high / low)**0.04))**(1 / order))
        end = min(end, begin * (end / begin)**0.75)
        if end < 1.3 * begin:
            return
        self.guide = [(time, factor * time**-order) for time in (begin, end)]
        self.axes.plot(*zip(*self.guide), color=GREY, linewidth=1, linestyle=(0, (4, 3)), zorder=1)

    def _floor(self) -> None:
        if self.shown.floor:
            low = self.axes.get_ylim()[0]
            self.axes.axhspan(low, self.shown.floor, facecolor="#eef0f3", edgecolor="none", zorder=0)

    def _wanted(self) -> None:
        if self.measure.want:
            self.axes.axhline(self.measure.want, color=INK, linewidth=1, linestyle=(0, (1, 2)), zorder=3)
        if self.best:
            self.axes.plot(*self.at(self.best), marker="*", markersize=15, markerfacecolor="#f2c53d", markeredgecolor=INK, markeredgewidth=0.9,
                           linestyle="none", zorder=7)

    # ---- words

    def place_words(self, renderer) -> None:
        self._label_ends(renderer)
        to_pixels = self.axes.transData.transform
        points = []
        for line in self.shown.lines:
            ends = [to_pixels(self.at(row)) for row in line.points]
            points += [*ends, *(a + (b - a) * k / 12 for a, b in zip(ends, ends[1:]) for k in range(12))]
        frame = self.axes.get_window_extent(renderer)
        room = Box(frame.x0 + 4, frame.y0 + 3, frame.x1 - 3, frame.y1 - (22 if self.shown.bad else 3))
        taken: List[Box] = []
        guide = [to_pixels(self.guide[0]) + (to_pixels(self.guide[1]) - to_pixels(self.guide[0])) * k / 40 for k in range(41)] if self.guide else []

        def level(error: float):
            return [(room.left + k * frame.width / 60, to_pixels((1, error))[1]) for k in range(60)]

        if self.best:
            star = to_pixels(self.at(self.best))
            taken.append(Box(star[0] - 9, star[1] - 9, star[0] + 9, star[1] + 9))
            words = f"{label_of(self.best, self.study.settings)}\n{written(float(f'{self.at(self.best)[0]:.3g}'))} {self.unit[1]}"
            text = self._text(words.replace(", ", "\n", 1), INK, "bold")
            box = free_place(tuple(star), self._size(renderer, text), room, taken, points + guide + level(self.measure.want))
            self._move(text, box, taken)
            near = (min(max(star[0], box.left), box.right), min(max(star[1], box.low), box.high))
            if math.dist(near, star) > 18:
                self.axes.plot(*zip(*map(self.axes.transData.inverted().transform, (star, near))), color=INK, linewidth=0.8, zorder=6)
                points += [star + (near - star) * k / 20 for k in range(21)]
        if self.measure.want:
            unit = f" {self.measure.unit}" if self.measure.unit not in ("", "-") else ""
            words = f"wanted: {written(self.measure.want)}{unit}" + ("" if self.best else "; no setting has it")
            self._along(renderer, words, level(self.measure.want), room, taken, points + guide, INK, False)
            points += level(self.measure.want)
        if self.guide:
            order = "" if self.shown.order == 1 else str(self.shown.order).translate(SUPERSCRIPTS)
            self._along(renderer, f"error ∝ 1/time{order}", guide[12:] + guide[:12], room, taken, points, "#6a737d", True)
        if self.shown.floor:
            self._along(renderer, "floor: finer steps gain nothing", level(self.shown.floor), room, taken, points + guide, "#6a737d", False)

    def _text(self, words: str, ink: str, weight: str = "normal"):
        return self.axes.text(0, 0, words, fontsize=8, color=ink, fontweight=weight, va="bottom", ha="left", linespacing=1.15, zorder=8,
                              bbox={"facecolor": "white", "alpha": 0.7, "edgecolor": "none", "pad": 1})

    def _size(self, renderer, text) -> Tuple[float, float]:
        extent = text.get_window_extent(renderer)
        return extent.width + 2, extent.height

    def _move(self, text, box: Box, taken: List[Box]) -> None:
        text.set_transform(None)
        text.set_position((box.left + 1, box.low))
        self.words.append(text)
        taken.append(box)

    def _along(self, renderer, words: str, line, room: Box, taken: List[Box], points, ink: str, falling: bool) -> None:
        text = self._text(words, ink)
        self._move(text, place_along(line, self._size(renderer, text), room, taken, points, falling), taken)

    def _label_ends(self, renderer) -> None:
        """Labels in a column right of the axes, each as near to the end of its line as the others leave room."""
        frame = self.axes.get_window_extent(renderer)
        ends = [self.axes.transData.transform(self.at(line.points[-1])) for line in self.shown.lines]
        labels = [(line.label, line.rank) for line in self.shown.lines] + [(f"{words}: no run ends", rank) for words, rank in self.shown.silent]
        wanted = [end[1] for end in ends] + [frame.y0 + 0.965 * frame.height] * len(self.shown.silent)
        texts = [self.axes.text(0, 0, words, fontsize=8.5, color=dark(colour(rank)), va="center", ha="left") for words, rank in labels]
        heights = [text.get_window_extent(renderer).height + 3 for text in texts]
        centres = spread(wanted, heights, frame.y0 - 8, frame.y1 + 4)
        inverse = self.axes.transData.inverted().transform
        for i, text in enumerate(texts):
            if not text.get_text():
                text.remove()
                continue
            text.set_transform(None)
            text.set_position((frame.x1 + 16, centres[i]))
            self.labels.append(text)
            if i < len(ends):
                self.axes.plot(*zip(*(inverse(p) for p in ((ends[i][0] + 5, ends[i][1]), (frame.x1 + 3, centres[i]), (frame.x1 + 12, centres[i])))),
                               color=colour(labels[i][1]), linewidth=0.8, alpha=0.75, clip_on=False, zorder=3)


def figure_of(study: Study):
    """The figure, and its PanelPictures."""
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    drawn = [measure for measure in study.measures if not is_round_off(study, measure)]
    shown = [(measure, panel(study, measure)) for measure in drawn]
    empty = [measure for measure, content in shown if not content.lines]
    shown = [(measure, content) for measure, content in shown if content.lines]
    sentences = [f"{measure.name}: no run has an error that can be drawn." for measure in empty]
    sentences += [sentence_of_round_off(study, measure) for measure in study.measures if measure not in drawn]
    longest = max((len(words) for _, content in shown for words in [line.label for line in content.lines] +
                   [f"{words}: no run ends" for words, _ in content.silent]), default=0)
    beside = 0.3 + LETTER * longest
    columns = min(2, max(1, len(shown)))
    rows = -(-len(shown) // columns)
    width = max(6.0, columns * (LEFT + PANEL + beside) + 0.1)
    # In an empty last place if there is one, else below all panels.
    spare = columns == 2 and len(shown) % 2 == 1
    room = PANEL + beside if spare else width - LEFT
    foot = [(line, True) for sentence in sentences for line in textwrap.wrap(sentence, int(room / BOLD_LETTER))]
    foot += [(line, False) for line in textwrap.wrap(" ".join(key_of(study, [content for _, content in shown])), int(room / LETTER))]
    height = 0.42 + rows * (ABOVE + HEIGHT + BELOW) + (0.1 if spare else 0.15 + WORDS * len(foot))
    with matplotlib.rc_context({**STYLE, "axes.titlesize": 10.5}):
        figure = Figure(figsize=(width, height), dpi=DPI, facecolor="white")
        FigureCanvasAgg(figure)
        times = [row.cpu for row in study.rows if row.cpu]
        unit = (1e-3, "ms") if times and max(times) < 0.9 else (1.0, "s")
        pictures = []
        for i, (measure, content) in enumerate(shown):
            left = LEFT + (i % columns) * (LEFT + PANEL + beside)
            top = height - 0.42 - (i // columns) * (ABOVE + HEIGHT + BELOW) - ABOVE
            axes = figure.add_axes((left / width, (top - HEIGHT) / height, PANEL / width, HEIGHT / height))
            pictures.append(PanelPicture(axes, study, measure, content, unit))
        figure.text(0.12 / width, 1 - 0.1 / height, f"{study.name.replace('_', ' ')}: error against run time", fontsize=13, fontweight="bold",
                    va="top", color="#22272e")
        x = (2 * LEFT + PANEL + beside if spare else LEFT) / width
        y = BELOW + HEIGHT if spare else 0.12 + WORDS * len(foot)
        for i, (text, bold) in enumerate(foot):
            figure.text(x, (y - WORDS * i) / height, text, fontsize=8.5, va="top", color=INK if bold else "#6a737d",
                        fontweight="bold" if bold else "normal")
        renderer = figure.canvas.get_renderer()
        for picture in pictures:
            picture.place_words(renderer)
    return figure, pictures


def draw(folder: pathlib.Path) -> pathlib.Path:
    """study.png of a folder with results.csv and plot.json."""
    figure, _ = figure_of(read(folder))
    draft = folder / "study.png.new"
    figure.savefig(draft, format="png", metadata={"Software": None})
    draft.replace(folder / "study.png")
    return folder / "study.png"
