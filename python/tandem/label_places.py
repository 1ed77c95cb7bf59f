"""Places for words in a chart where they cover neither each other nor what is drawn. All lengths are in pixels."""
from typing import Iterable, List, NamedTuple, Sequence, Tuple


class Box(NamedTuple):
    """A rectangle, from its lower left to its upper right corner."""
    left: float
    low: float
    right: float
    high: float

    def meets(self, other: "Box") -> bool:
        return self.left < other.right and other.left < self.right and self.low < other.high and other.low < self.high

    def inside(self, other: "Box") -> bool:
        return self.left >= other.left and self.low >= other.low and self.right <= other.right and self.high <= other.high


def spread(wanted: Sequence[float], heights: Sequence[float], low: float, high: float) -> List[float]:
    """Centres of labels in a column, as near to the wanted ones as they can be without overlap, within low and high if there is room.

    Labels that would overlap form a block around the mean of what they want; blocks that meet are joined."""
    order = sorted(range(len(wanted)), key=lambda i: wanted[i])
    blocks: List[List[int]] = []
    begins: List[float] = []

    def height(block: List[int]) -> float:
        return sum(heights[i] for i in block)

    def begin(block: List[int]) -> float:
        below, begins_wanted = 0.0, 0.0
        for i in block:
            begins_wanted += wanted[i] - below - heights[i] / 2
            below += heights[i]
        return max(low, min(begins_wanted / len(block), high - below))

    for i in order:
        blocks.append([i])
        begins.append(begin(blocks[-1]))
        while len(blocks) > 1 and begins[-2] + height(blocks[-2]) > begins[-1]:
            blocks[-2:] = [blocks[-2] + blocks[-1]]
            begins[-2:] = [begin(blocks[-1])]
    centres = [0.0] * len(wanted)
    for block, at in zip(blocks, begins):
        for i in block:
            centres[i] = at + heights[i] / 2
            at += heights[i]
    return centres


def free_place(anchor: Tuple[float, float], size: Tuple[float, float], room: Box, taken: Iterable[Box], points: Sequence[Tuple[float, float]],
               reach: float = 160) -> Box:
    """A box of this size near the anchor, inside the room, which meets no other box and has few of the points (of lines) in it."""
    taken = list(taken)
    width, height = size
    best, least = None, float("inf")
    for distance in range(8, int(reach), 12):
        for dx, dy in ((1, 1), (-1, 1), (1, -1), (-1, -1), (0, 1), (0, -1), (1, 0), (-1, 0)):
            x = anchor[0] + dx * distance + (0 if dx > 0 else -width if dx < 0 else -width / 2)
            y = anchor[1] + dy * distance + (0 if dy > 0 else -height if dy < 0 else -height / 2)
            box = Box(x, y, x + width, y + height)
            if not box.inside(room):
                continue
            covered = sum(box.left - 3 < px < box.right + 3 and box.low - 3 < py < box.high + 3 for px, py in points)
            cost = distance + 60 * covered + 10_000 * sum(box.meets(other) for other in taken)
            if cost < least:
                best, least = box, cost
    if best is None:  # no room at all: the corner of the room that is nearest
        x = min(max(anchor[0], room.left), room.right - width)
        y = min(max(anchor[1], room.low), room.high - height)
        best = Box(x, y, x + width, y + height)
    return best


def place_along(points: Sequence[Tuple[float, float]], size: Tuple[float, float], room: Box, taken: Iterable[Box],
                obstacles: Sequence[Tuple[float, float]], falling: bool) -> Box:
    """A box beside a line through the points: above or below a level one, at the lower left or upper right of a falling one."""
    taken = list(taken)
    width, height = size
    best, least = None, float("inf")
    for rank, (x, y) in enumerate(points):
        for side, (left, low) in enumerate(((x - width - 4, y - height - 3), (x + 4, y + 3)) if falling else ((x, y + 2), (x, y - height - 2))):
            box = Box(left, low, left + width, low + height)
            if not box.inside(room):
                continue
            covered = sum(box.left < px < box.right and box.low < py < box.high for px, py in obstacles)
            cost = rank + 4 * side + 60 * covered + 10_000 * sum(box.meets(other) for other in taken)
            if cost < least:
                best, least = box, cost
    return best or free_place(points[len(points) // 2], size, room, taken, obstacles)
