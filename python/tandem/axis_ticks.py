"""Ticks of logarithmic axes as people write them: 0.2, 0.5, 1, 2 over a short range, powers of ten over a long one."""
import math
from typing import List, Tuple

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def written(value: float) -> str:
    """'0.02', '5', '2·10⁻⁴', '10⁻⁶'."""
    exponent = math.floor(math.log10(value) + 1e-9)
    share = value / 10.0**exponent
    if -2 <= exponent <= 3:
        return f"{value:.4g}"
    power = "10" + str(exponent).translate(SUPERSCRIPTS)
    return power if abs(share - 1) < 1e-6 else f"{share:.3g}·{power}"


def log_ticks(low: float, high: float, most: int = 8) -> Tuple[List[float], List[float]]:
    """Values with words, and those with a small tick only: multiples of 1, 2 and 5 of powers of ten, or every power, or every n-th one."""
    first, last = math.floor(math.log10(low)), math.ceil(math.log10(high))

    def within(factors) -> List[float]:
        values = [factor * 10.0**power for power in range(first, last + 1) for factor in factors]
        return [value for value in values if low * (1 - 1e-9) <= value <= high * (1 + 1e-9)]

    minor = within(range(1, 10)) if last - first <= 8 else []
    for factors in ((1, 2, 3, 4, 5, 6, 7, 8, 9), (1, 2, 3, 5), (1, 2, 5), (1, 3), (1,)):
        if len(within(factors)) <= most and (len(within(factors)) >= 2 or factors == (1,)):
            return within(factors), minor
    step = math.ceil(len(within((1,))) / most)
    return within((1,))[::step], within((1,))
