"""What `tandem soften` changes in a scene: moduli of the grains, micro step, window, the random numbers of the start."""
import math
from typing import Any, Dict, List, Optional, Tuple

from tandem.entries import SceneError
from tandem.scenes import Scene

LONGEST_STEP = 0.4  # of the critical time; longer micro steps are refused
LONGEST_TRIED = 0.39  # the limit is that of the smallest radius that the scene allows, which may be below the smallest one that is there
# Keys that are divided by the divisor of the modulus, and by its root: the damping of the law `paper` then dissipates as before.
STIFFNESSES = ("young", "spring_stiffness", "normal_stiffness", "tangential_stiffness")
DAMPINGS = ("normal_damping", "tangential_damping")


def expect_grains(scene: Scene) -> None:
    """Refuses a scene whose grains cannot be softened."""
    if "dem" not in scene.data or not scene.data["dem"].get("particles"):
        hint = ("in a liquid the speed of sound limits the step: sph.sound_speed" if "sph" in scene.data else
                "without grains no contact limits the step: tandem study compares steps of a machine")
        raise SceneError("the scene has no grains to soften", f"{scene.name}: dem.particles", hint)


def softened(scene: Scene, taken: Dict[str, float], divisor: float, step: float, window: float, start: int = 1,
             overlap_limit: Optional[float] = None) -> Scene:
    """A copy of the scene whose grains have their moduli divided. `step` is the micro step [s], 0: that of the scene; `taken` are the moduli that
    it takes from the library of materials; `start` counts random starts, 1 is that of the scene."""
    soft = scene.copy()
    dem = soft.data["dem"]
    if divisor != 1:
        _write_moduli_of_library(dem, taken)
        for entry in dem.get("materials", []) + dem.get("pairs", []):
            for keys, by in ((STIFFNESSES, divisor), (DAMPINGS, math.sqrt(divisor))):
                for key in keys:
                    if key in entry:
                        entry[key] = _divided(entry[key], by)
    if step:
        dem["micro_step"] = step
    if overlap_limit is not None:
        dem["overlap_limit"] = overlap_limit
    if "adaptive" not in soft.data.get("coupling", {}):
        soft.section("coupling")["window"] = window
    for fill in random_fills(soft):
        fill["seed"] = fill.get("seed", 1) + start - 1
    return soft


def _write_moduli_of_library(dem: Dict[str, Any], taken: Dict[str, float]) -> None:
    materials = dem.setdefault("materials", [])
    for figure, value in taken.items():
        name = figure[:-len(".young")]
        entry = next((m for m in materials if m.get("name") == name), None)
        if entry is None:
            entry = {"name": name}
            materials.append(entry)
        entry.setdefault("young", value)


def _divided(value: Any, by: float) -> Any:
    if isinstance(value, str):  # an expression
        return f"=({value[1:]})/{by:.12g}"
    return float(f"{value / by:.12g}")


def moduli_of_library(parameters: Dict[str, Any]) -> Dict[str, float]:
    """Those in `parameters` of a summary, as {"glass.young": 7.1e10}."""
    return {name: entry["value"] for name, entry in parameters.items() if name.endswith(".young") and isinstance(entry, dict)}


def random_fills(scene: Scene) -> List[Dict[str, Any]]:
    """The fills whose spheres depend on a seed."""
    found = []
    for group in scene.entries("dem.particles"):
        fill = group.get("fill", {})
        by_chance = fill.get("type") in ("packing", "inlet") or (fill.get("type") == "lattice" and (
            fill.get("jitter", 0) != 0 or isinstance(group.get("radius"), list)))
        if by_chance and isinstance(fill.get("seed", 1), int):
            found.append(fill)
    return found


# ---- levels of the three axes

def moduli(largest: float = 1024) -> List[float]:
    """Divisors of the modulus."""
    return [2.0**i for i in range(int(math.log2(largest)) + 1)]


def shares(own: float) -> List[float]:
    """Micro steps as shares of the critical time, from that of the scene to the longest, by factors of the root of two."""
    count = int(2 * math.log2(LONGEST_TRIED / own) + 1e-9) if own < LONGEST_TRIED else 0
    found = [own * 2**(i / 2) for i in range(count + 1)]
    return found + ([LONGEST_TRIED] if found[-1] < 0.8 * LONGEST_TRIED else [])


def windows(scene: Scene, window: float) -> List[float]:
    """Windows from that of the scene on, each about twice as long as the one before; end and frames are at ends of windows."""
    if "adaptive" in scene.data.get("coupling", {}):
        return [window]
    own, spans = _nanoseconds(window), [_nanoseconds(span) for span, _ in _whole_spans(scene)]
    found = [own]
    for k in range(2, min(spans) // own + 1):
        if all(span % (k * own) == 0 for span in spans) and k * own >= 1.8 * found[-1]:
            found.append(k * own)
    return [float(f"{each * 1e-9:.12g}") for each in found]


def expect_window(scene: Scene, window: float) -> None:
    """Refuses a window of which the run, or the time between frames, has no whole number."""
    if not window > 0:
        raise SceneError(f"{window:.6g} s is no window", "--window", "give times in s, as in --window 0.001,0.002")
    for span, what in _whole_spans(scene):
        if _nanoseconds(span) % max(1, _nanoseconds(window)):
            fit = ", ".join(f"{each:g}" for each in windows(scene, scene.window)[1:])
            raise SceneError(f"{what} of {span:.6g} s is not a whole multiple of the window of {window:.6g} s", "--window",
                             f"these fit: {fit}" if fit else "no longer one fits")


def _whole_spans(scene: Scene) -> List[Tuple[float, str]]:
    frames = scene.data.get("output", {}).get("frame_interval", 0)
    spans = [(scene.end_time, "end_time")] + ([(frames, "output.frame_interval")] if frames else [])
    for value, what in spans:
        if not isinstance(value, (int, float)):
            raise SceneError(f"{what} is the expression '{value}'", scene.name, "write it as a number: windows must divide it")
    return spans  # type: ignore[return-value]


def longest_window(scene: Scene, window: float) -> float:
    """[s]: that of coupling.adaptive, or `window`."""
    largest = scene.data.get("coupling", {}).get("adaptive", {}).get("max_window")
    return largest if isinstance(largest, (int, float)) else window


def steps_in(window: float, step: float, limit: float) -> int:
    """Micro steps of a window, which holds whole ones, none longer than `step` but for rounding, and all shorter than `limit` [s]. The critical
    time goes with the root of the modulus: a step that grows longer than the window becomes as long as the window."""
    count = max(1, math.ceil(window / step * (1 - 1e-6)))
    return count if window / count < limit * (1 - 5e-7) else count + 1


def _nanoseconds(seconds: float) -> int:
    return round(seconds * 1e9)
