#!/usr/bin/env python3
"""Adds a run's figures to a CSV of benchmark results, taken from its summary.json and not typed.

usage: record.py CSV FOLDER_OF_RESULTS COMMIT COMMAND [COLUMN...]
COLUMN: more keys of the summary; a CSV has the columns that it was begun with.
"""
import csv
import datetime
import json
import os
import sys

COLUMNS = ["date", "commit", "device", "command", "scene", "backend", "variant", "spheres", "micro_steps", "wall_s",
           "us_per_micro_step", "exchange_share", "state_hash", "status"]


def record(path, summary, commit, command, more):
    """Adds a row of COLUMNS and of `more` keys of the summary to the CSV at `path`."""
    columns = COLUMNS + more
    row = {column: summary.get(column) for column in COLUMNS} | {column: summary[column] for column in more}
    row["date"] = datetime.date.today().isoformat()
    row["commit"], row["command"] = commit, command
    row["wall_s"] = round(summary["wall_s"], 3)
    row["us_per_micro_step"] = round(summary["us_per_micro_step"], 3)
    row["exchange_share"] = round(summary["time_split"]["exchange"] / summary["wall_s"], 4)
    fresh = not os.path.exists(path)
    if not fresh:
        with open(path, newline="") as file:
            if next(csv.reader(file)) != columns:
                sys.exit(f"{path} has other columns than {','.join(columns)}")
    with open(path, "a", newline="") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        if fresh:
            writer.writeheader()
        writer.writerow(row)


def main():
    if len(sys.argv) < 5:
        sys.exit(__doc__)
    path, folder, commit, command = sys.argv[1:5]
    with open(os.path.join(folder, "summary.json")) as file:
        record(path, json.load(file), commit, command, sys.argv[5:])


if __name__ == "__main__":
    main()
