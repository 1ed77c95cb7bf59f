"""What report.html is made of: the CSV files of a run, and its present status."""
import csv
import itertools
import subprocess

import numpy as np

MOST_ROWS = 100_000  # that are read of a file; of a longer file as many in all, at STRETCHES places
STRETCHES = 1000


def read_columns(file, notes=None):
    """Columns of a CSV file by name; a last line truncated by a crash is dropped. Empty without file or rows.

    Of a long file only stretches are read, so that any run has a report: `notes` gets a sentence about that.
    """
    if not file.exists():
        return {}
    with open(file, "rb") as lines:
        names = next(csv.reader([lines.readline().decode()]), [])
        begin, size = lines.tell(), file.stat().st_size
        if size <= begin:
            return {}
        many = (size - begin) / max(len(lines.readline()), 1)
        if many <= MOST_ROWS:
            places, each = [begin], None
        else:
            places, each = np.linspace(begin, size, STRETCHES, endpoint=False).astype(int), MOST_ROWS // STRETCHES
        rows, length = [], 0
        for place in places:
            lines.seek(place - 1)
            lines.readline()  # to the begin of the next row
            for line in itertools.islice(lines, each):
                cells = line.split(b",")
                if not line.endswith(b"\n") or len(cells) != len(names):
                    break
                rows.append(np.array(cells, dtype=float))
                length += len(line)
    if each and rows and notes is not None:
        notes.append(f"{file.name} has about {(size - begin) * len(rows) / length:.2g} rows: the charts show {each} in a row at each "
                     f"of {STRETCHES} places; what peaks in between is not in them.")
    return dict(zip(names, np.array(rows).T)) if rows else {}


def status_now(summary, folder, tandem):
    """The present `status`: `tandem ps` determines whether a run with the status `running` is still in progress.

    `tandem`: the program's path."""
    if summary.get("status") != "running":
        return summary.get("status")
    if not tandem.exists():
        return "running or died"
    said = subprocess.run([tandem, "ps", "--status", folder], capture_output=True, text=True, timeout=60)
    return said.stdout.strip() if said.returncode == 0 else "running or died"


def groups(columns, suffix):
    """The NAMEs of all columns NAME.suffix, in file order."""
    return [name[: -len(suffix) - 1] for name in columns if name.endswith("." + suffix)]
