"""What is shown while a run is in progress, and what notebooks show of it."""
import base64
import html
import pathlib
import sys
import time


def in_notebook() -> bool:
    """Whether this is a Jupyter kernel."""
    shell = sys.modules.get("IPython")
    shell = shell.get_ipython() if shell else None
    return shell is not None and hasattr(shell, "kernel")


class Picture:
    """A PNG file, which notebooks show."""

    def __init__(self, path):
        self.path = pathlib.Path(path)

    def __repr__(self) -> str:
        return f"<Picture {self.path}>"

    def _repr_png_(self) -> bytes:
        return self.path.read_bytes()


def image_html(data: bytes) -> str:
    """A picture beside words: of an object with both, notebooks show the HTML only."""
    return f'<img src="data:image/png;base64,{base64.b64encode(data).decode()}" style="max-width:100%">'


def text_html(text: str) -> str:
    """Text whose columns stay aligned, whatever the style of the notebook."""
    return f'<pre style="font-family:monospace;line-height:1.3">{html.escape(text)}</pre>'


def _text(run) -> str:
    end, now = run.scene.end_time, run.time
    elapsed = time.monotonic() - run.begin
    if not isinstance(end, (int, float)) or end <= 0 or now <= 0:
        return f"{run.scene.name}: starting, {elapsed:.0f} s"
    left = elapsed * (end - now) / now
    return f"{run.scene.name}: t = {now:.4g} of {end:g} s ({100 * now / end:.0f} %), {elapsed:.0f} s, {max(left, 0):.0f} s left"


def progress_html(run) -> str:
    """A bar and its text."""
    end = run.scene.end_time
    share = min(1.0, run.time / end) if isinstance(end, (int, float)) and end > 0 else 0.0
    return (f'<div style="font-family:sans-serif"><progress value="{share:.4f}" max="1" style="width:20em"></progress> '
            f"{html.escape(_text(run))}</div>")


class ProgressLine:
    """A line on the terminal that is written anew, a bar in a notebook, or a line every ten seconds in a file."""

    def __init__(self, run):
        self.run, self.last, self.display = run, 0.0, None
        self.terminal = sys.stderr.isatty()
        if in_notebook():
            from IPython.display import HTML, display  # noqa: F401 (of the notebook, where it is there)
            self.html, self.display = HTML, display(HTML(progress_html(run)), display_id=True)

    def update(self) -> None:
        if self.display is not None:
            self.display.update(self.html(progress_html(self.run)))
        elif self.terminal:
            print(f"\r{_text(self.run)}\033[K", end="", file=sys.stderr, flush=True)
        elif time.monotonic() - self.last > 10:
            self.last = time.monotonic()
            print(_text(self.run), file=sys.stderr, flush=True)

    def close(self) -> None:
        if self.display is not None:
            self.update()
        elif self.terminal:
            print(f"\r{_text(self.run)}\033[K", file=sys.stderr)
