"""What `tandem soften` prints."""
import math
from typing import List


def percent(share: float) -> str:
    """0.0025 as "0.25 %"."""
    return f"{100 * share:.2g} %"


def table(found) -> str:
    """All settings that were run, the stiff one first; its errors are the scatter."""
    names = [measure.of for measure in found.measures]
    lines = [["modulus", "step/critical", "window [ms]"] + names + ["wall [s]", "dem [s]", "mbd, exchange [s]", "output [s]", "overlap", ""]]
    for each in [found.stiff] + found.candidates:
        is_stiff = each is found.stiff
        errors = found.scatter if is_stiff else each.errors
        mark = stiff_mark(each) if is_stiff else "chosen" if each is found.chosen else shortened(each.fault)
        parts = [each.parts.get("dem"), each.parts.get("mbd", 0) + each.parts.get("exchange", 0) if each.parts else None, each.parts.get("output")]
        lines.append([f"/ {each.setting.divisor:g}", f"{each.share:.3g}", f"{1e3 * each.setting.window:g}"] +
                     [percent(errors[name]) if math.isfinite(errors.get(name, math.nan)) else "-" for name in names] +
                     [f"{each.wall_s:.3g}"] + ["-" if part is None else f"{part:.3g}" for part in parts] + [f"{each.overlap:.2g}", mark])
    widths = [max(len(line[i]) for line in lines) for i in range(len(lines[0]))]
    return "\n".join("  ".join(word.rjust(width) if i < len(widths) - 1 else word for i, (word, width) in enumerate(zip(line, widths))).rstrip()
                     for line in lines)


def stiff_mark(stiff) -> str:
    return ("" if stiff.status == "ok" else f"SUSPECT by {', '.join(stiff.rules)}; ") + "stiff: its errors are the scatter"


def doubts(stiff) -> List[str]:
    """Loud lines where the scene as it is, against which all errors are, is suspect."""
    if stiff.status == "ok":
        return []
    return ["WARNING: the scene as it is is itself suspect. All errors are relative to it, so that they say nothing about the truth:"] + [
        f"  {rule}: {sentence}" for rule, sentence in stiff.rules.items()] + [""]


def reading(found) -> str:
    """What was found, what it costs, and what limits."""
    names = [measure.of for measure in found.measures]
    lines = [f"wanted: {percent(found.wanted)} of " + ", ".join(names), ""] + doubts(found.stiff) + [table(found), ""]
    loud = [name for name in names if found.scatter[name] > found.wanted]
    if loud:
        worst = max(found.scatter[name] for name in loud)
        return "\n".join(lines + [
            "nothing is written: runs of the stiff scene that differ by their random start alone differ by " +
            ", ".join(f"{percent(found.scatter[name])} of {name}" for name in loud) + ", so that a smaller error means nothing",
            f"write --error {_rounded_up(worst)}, or name a result that scatters less: a mean or an integral over a longer time"])
    if found.chosen is None:
        lines += ["nothing is written: no softer setting is faster within the wanted error", ""]
    else:
        lines += _found(found)
    return "\n".join(lines + ["what limits"] + [f"  {line}" for line in found.limits])


def _found(found) -> List[str]:
    chosen, stiff = found.chosen, found.stiff
    lines = [f"found: {chosen.setting}",
             f"  {chosen.wall_s:.3g} s of wall time instead of {stiff.wall_s:.3g} s: {stiff.wall_s / chosen.wall_s:.2g} times as fast"]
    for name, error in chosen.errors.items():
        scatter = found.scatter[name]
        at_scatter = math.isfinite(scatter) and error <= 1.5 * scatter
        lines.append(f"  {name}: {percent(error)}" + (f", scatter {percent(scatter)}" if math.isfinite(scatter) else "") +
                     (": no more than another random start changes it" if at_scatter else ""))
    lines.append(f"  overlaps up to {chosen.overlap:.2g} of the radius; overlap_limit of the softened scene: {found.overlap_limit:g}")
    return lines + [f"  written: {found.file}", ""]


def _rounded_up(share: float) -> str:
    """The next error of one digit, as for --error."""
    unit = 10.0**math.floor(math.log10(100 * share))
    return f"{math.ceil(100 * share / unit) * unit:g}%"


def shortened(text: str, most: int = 60) -> str:
    return text if len(text) <= most else text[:most - 3] + "..."
