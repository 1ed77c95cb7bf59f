"""What stands below the panels of a study: sentences in place of panels, and the key to what is drawn."""
from typing import List

from tandem.axis_ticks import written
from tandem.study_data import Measure, Study, recommended
from tandem.study_lines import Panel


def sentence_of_round_off(study: Study, measure: Measure) -> str:
    errors = [error for row in study.rows if (error := row.error(measure.name)) is not None]
    unit = f" {measure.unit}" if measure.unit not in ("", "-") else ""
    return (f"{measure.name.replace('_', ' ')}: at most {written(float(f'{max(errors):.2g}'))}{unit} in all {len(errors)} runs. "
            "That is round-off: no setting matters.")


def key_of(study: Study, panels: List[Panel]) -> List[str]:
    """Sentences below the panels that say what is drawn; only of what is there."""
    out: List[str] = []
    rest = [name for name in study.others() if any(name not in shown.settings for shown in panels)]
    if rest:
        names = ", ".join(name.rpartition("/")[2] for name in rest + [study.line] * bool(study.line))
        out.append(f"Line: least error of a method within a time. Band: its other settings ({names}), with a dot for each run.")
    if study.line and any(shown.settings == study.others() for shown in panels):
        out.append(f"Line{' without a band' if rest else ''}: {study.line.rpartition('/')[2]} becomes smaller along it; each point is a run.")
    if study.repeat > 1:
        out.append(f"Times are medians of {study.repeat} runs; bars go from the shortest to the longest.")
    if any(recommended(study, measure) for measure in study.measures):
        out.append("★ the fastest setting with the wanted error.")
    if any(row.status == "suspect" for row in study.rows):
        out.append("Amber ring: the verdict calls the run suspect.")
    bad = panels[0].bad if panels else []
    if bad:
        kinds = " or ".join(dict.fromkeys(row.status.replace("_", " ") for row, _ in bad))
        out.append(f"× at the upper edge: {len(bad)} runs that {kinds if kinds == 'diverged' else 'are ' + kinds}, and have no error.")
    if any(shown.others for shown in panels):
        out.append(f"Grey dots: runs of the methods beyond the best {len(panels[0].lines)}.")
    return out
