"""Settings of a softened scene, and what their runs have shown."""
import math
import statistics
from typing import Dict, List, NamedTuple

from tandem.sweeps import Row


class Setting(NamedTuple):
    """What is changed: divisor of the moduli, micro step over the critical time, window [s]."""
    divisor: float
    share: float
    window: float

    def __str__(self) -> str:
        return f"modulus / {self.divisor:g}, micro step {self.share:.3g} of the critical time, window {1e3 * self.window:g} ms"


class Candidate:
    """A setting that was run, with the share of the critical time that its micro step had, and as `asked` for: `errors` of each result, relative, rms over the random starts; `wall_s`, their median, with `times`; `parts` of that
    time; `overlap`; `status` and `fault` of its runs."""

    def __init__(self, setting: Setting, rows: List[Row]):
        self.asked, self.rows = setting, rows
        self.errors: Dict[str, float] = {}
        self.first_errors: Dict[str, float] = {}  # of the first start
        self.fault = ""
        done = [row for row in rows if row.status in ("ok", "suspect")]
        summaries = [row.results.summary for row in done]
        self.times = [summary["wall_s"] for summary in summaries]
        self.wall_s = statistics.median(self.times) if self.times else math.nan
        self.parts = {part: statistics.median([s["time_split"].get(part, 0.0) for s in summaries]) for part in ("dem", "mbd", "exchange", "output")
                      } if summaries else {}
        self.overlap = max((summary.get("max_overlap_ratio", 0.0) for summary in summaries), default=math.nan)
        self.steps = summaries[0]["micro_steps"] if summaries else 0
        self.windows = summaries[0]["windows"] if summaries else 0
        self.share = summaries[0]["micro_step_s"] / summaries[0]["critical_time_s"] if summaries else setting.share
        self.setting = setting._replace(share=self.share)
        self.step_s = summaries[0]["micro_step_s"] if summaries else math.nan
        self.rules = {line.get("rule"): line.get("sentence", "") for s in summaries for line in (s.get("verdict") or {}).get("lines", [])}
        bad = next((row for row in rows if row.status not in ("ok", "suspect")), None)
        self.status = bad.status if bad else "suspect" if any(row.status == "suspect" for row in rows) else "ok"
        if bad:
            self.fault = f"{bad.status}: {bad.reason}"
