"""Values of a scene that are more than a number: functions of time, distributions of sizes, expressions."""
import math
from typing import Any, Dict, Optional, Sequence, Union

from tandem.entries import Entry, SceneError, calling_line, plain


def deg(angle: float) -> float:
    """An angle in degrees as radians: td.deg(90) is 1.5707963."""
    if isinstance(angle, (str, Expression)):
        raise SceneError(f"td.deg() takes a number, and gets {str(angle)!r}", hint='write an angle of a formula as "=30*deg", or give a parameter unit="deg"')
    return math.radians(angle)


def table(times: Sequence[float], values: Sequence[float], interpolation: Optional[str] = None, of: Optional[str] = None,
          smoothing: Optional[float] = None) -> Entry:
    """A function of time through points. `times` [s] increase; the first and the last value are held outside.

    interpolation  "monotone" (default: smooth, never beyond its points), "linear", "step" or "spline"
    of             "speed": the values are rates of a joint's coordinate
    smoothing      [s], which a "linear" or "step" motion of a joint needs
    """
    for name, column in (("times", times), ("values", values)):
        if isinstance(column, str) or not hasattr(column, "__len__"):
            raise SceneError(f"{name} of a table is {column!r}", hint="give two lists of numbers, as td.table([0, 1], [0, 0.5])")
    if len(times) != len(values):
        raise SceneError(f"a table has {len(times)} times and {len(values)} values", hint="give one value for each time")
    return _function("table", times=times, values=values, interpolation=interpolation, of=of, smoothing=smoothing)


def ramp(to: float, duration: float, start: Optional[float] = None, from_: Optional[float] = None,
         of: Optional[str] = None) -> Entry:
    """A smooth change from `from_` (0) to `to` within `duration` [s], beginning at `start` [s]; `of` "speed" as for table()."""
    keys: Dict[str, Any] = {"to": to, "duration": duration, "start": start, "from": from_, "of": of}
    return _function("ramp", **keys)


def harmonic(amplitude: float, frequency: float, offset: Optional[float] = None, phase: Optional[float] = None) -> Entry:
    """offset + amplitude sin(2 pi frequency t + phase); frequency in Hz, phase in rad."""
    return _function("harmonic", amplitude=amplitude, frequency=frequency, offset=offset, phase=phase)


def constant(value: float = 0, rate: Optional[float] = None) -> Entry:
    """value + rate t."""
    return _function("constant", value=value, rate=rate)


def _function(kind: str, **keys) -> Entry:
    given = {key: plain(value) for key, value in keys.items() if value is not None}
    return Entry({"type": kind, **given}, made_at=calling_line())


def function_of_time(value: Any) -> Any:
    """A number, a list of (time, value) pairs, or a function as it is."""
    value = plain(value)
    if isinstance(value, (int, float, str)):
        return {"type": "constant", "value": value}
    if isinstance(value, list):
        if not all(isinstance(pair, list) and len(pair) == 2 for pair in value):
            raise SceneError(f"{value!r} is no function of time", hint="give a number, pairs (time, value) as [(0, 0), (1, 0.5)], or td.table(times, values)")
        return table([pair[0] for pair in value], [pair[1] for pair in value])
    return value


def _round(value: float) -> float:
    return float(f"{value:.6g}")


def _expect_sizes(of: str, **sizes: Any) -> None:
    for name, value in sizes.items():
        value = value.tolist() if hasattr(value, "tolist") else value
        if not isinstance(value, (int, float)) or not value > 0:
            said = str(value) if isinstance(value, Expression) else value
            raise SceneError(f"{name} of {of} is {said!r}", hint="give a number above 0; with min= and max= it may be a formula")


def normal(mean: float, deviation: float, min: Optional[float] = None, max: Optional[float] = None) -> Entry:
    """Radii [m] of a normal distribution by number, cut off at `min` and `max` (default: two deviations from the mean)."""
    if min is None or max is None:
        _expect_sizes("td.normal()", mean=mean, deviation=deviation)
    return _function("normal", mean=mean, deviation=deviation, min=_round(mean - 2 * deviation) if min is None else min,
                     max=_round(mean + 2 * deviation) if max is None else max)


def log_normal(median: float, deviation: float, min: Optional[float] = None, max: Optional[float] = None) -> Entry:
    """Radii [m] of a log-normal distribution by number; `deviation` is that of ln(radius), cut off at two of them by default."""
    if min is None or max is None:
        _expect_sizes("td.log_normal()", median=median, deviation=deviation)
    if isinstance(deviation, (int, float)) and deviation > 10:
        raise SceneError(f"deviation of td.log_normal() is {deviation!r}", hint="it is that of ln(radius), without a unit: 0.2 is some 20 %")
    return _function("log_normal", median=median, deviation=deviation,
                     min=_round(median * math.exp(-2 * deviation)) if min is None else min,
                     max=_round(median * math.exp(2 * deviation)) if max is None else max)


def sieve(size: Sequence[float], passing: Sequence[float]) -> Entry:
    """Sizes from a sieve curve: openings, which are diameters [m], and the share of the mass that passes each."""
    return _function("sieve", size=size, passing=passing)


class Expression:
    """A formula of parameters, which the scene keeps: mouth = s.parameter("mouth", 0.06); then mouth/2 + 0.01 may be given
    wherever a scene takes a number. It prints as the text of the file, '=mouth/2 + 0.01'."""

    def __init__(self, text: str):
        self.text = text.lstrip("=")

    def as_json(self) -> str:
        return "=" + self.text

    __str__ = as_json

    def __repr__(self) -> str:
        return f"Expression('{self}')"

    def _with(self, operator: str, other: Any, swapped: bool = False) -> "Expression":
        other = other.text if isinstance(other, Expression) else repr(float(other)) if not isinstance(other, int) else str(other)
        first, second = (other, self.text) if swapped else (self.text, other)
        wrap = (lambda t: t if t.replace("_", "").replace(".", "").isalnum() else f"({t})")
        return Expression(f"{wrap(first)} {operator} {wrap(second)}")

    def __add__(self, other): return self._with("+", other)
    def __radd__(self, other): return self._with("+", other, True)
    def __sub__(self, other): return self._with("-", other)
    def __rsub__(self, other): return self._with("-", other, True)
    def __mul__(self, other): return self._with("*", other)
    def __rmul__(self, other): return self._with("*", other, True)
    def __truediv__(self, other): return self._with("/", other)
    def __rtruediv__(self, other): return self._with("/", other, True)
    def __pow__(self, other): return self._with("^", other)
    def __neg__(self): return Expression(f"-({self.text})")


Number = Union[float, str, Expression]


def has_formula(value: Any) -> bool:
    """Whether a value, or a part of it, is a formula of parameters."""
    if isinstance(value, dict):
        return any(has_formula(part) for part in value.values())
    if isinstance(value, (list, tuple)):
        return any(map(has_formula, value))
    return isinstance(value, Expression) or (isinstance(value, str) and value.startswith("="))


def formula(value: Any) -> Any:
    """A formula that is a text as an Expression, with which Python can compute; all else as it is."""
    return Expression(value) if isinstance(value, str) and value.startswith("=") else value


def axis(value: Any) -> Any:
    """'x', '-y', ... or a direction of any length, as a unit vector."""
    if isinstance(value, str) and not value.startswith("="):
        sign, name = (-1, value[1:]) if value.startswith("-") else (1, value.lstrip("+"))
        if name not in ("x", "y", "z"):
            raise SceneError(f"'{value}' is no axis", hint="give 'x', 'y', 'z', '-x', '-y', '-z' or three numbers")
        return [sign if name == other else 0 for other in "xyz"]
    value = plain(value)
    if isinstance(value, list) and len(value) == 3 and all(isinstance(x, (int, float)) for x in value):
        length = math.sqrt(sum(x * x for x in value))
        return value if length == 0 or abs(length - 1) < 1e-12 else [x / length for x in value]
    return value
