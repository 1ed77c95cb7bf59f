"""The pages of the project as the checks read them: prose, code blocks, anchors, tables."""
import re

FENCE = re.compile(r"^\s*```(.*)$")
HEADING = re.compile(r"^#{1,6}\s+(.*?)\s*$")


class Page:
    """A Markdown file: its lines with code blocks taken out, its code blocks, and the anchors of its headings."""

    def __init__(self, path):
        self.path = path
        self.prose = []   # (line number, text) outside of code blocks
        self.blocks = []  # (line number, info, text)
        info = begin = text = None
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
            fence = FENCE.match(line)
            if fence and info is None:
                info, begin, text = fence[1].strip(), number, []
            elif fence:
                self.blocks.append((begin, info, "\n".join(text)))
                info = None
            elif info is not None:
                text.append(line)
            else:
                self.prose.append((number, line))

    def anchors(self):
        """As GitHub makes them from headings."""
        found = {}
        for _, line in self.prose:
            heading = HEADING.match(line)
            if not heading:
                continue
            text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading[1]).replace("`", "").lower()
            anchor = re.sub(r"[^\w\- ]", "", text).replace(" ", "-")
            count = found.get(anchor, 0)
            found[anchor] = count + 1
            yield anchor if count == 0 else f"{anchor}-{count}"


def pages(root):
    found = [root / name for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md")]
    found += sorted((root / "docs").rglob("*.md")) + sorted((root / "tests").rglob("README.md"))
    return [Page(path) for path in found if path.is_file()]


def place(root, page, number):
    return f"{page.path.relative_to(root)}:{number}"


def cells(line):
    return [cell.strip() for cell in line.strip().strip("|").replace("\\|", "¦").split("|")]


def marked_tables(page, word):
    """For each `<!-- WORD: NAMES -->`: its line, the names, the rows of the table after it as dictionaries, the text of its section."""
    lines = page.prose
    for index, (number, line) in enumerate(lines):
        mark = re.match(rf"<!-- {word}: (.*) -->$", line)
        if not mark:
            continue
        at = index + 1
        while at < len(lines) and not lines[at][1].startswith("|"):
            at += 1
        end = at
        while end < len(lines) and lines[end][1].startswith("|"):
            end += 1
        table = [cells(text) for _, text in lines[at:end]]
        rows = [dict(zip(table[0], row)) for row in table[2:]] if len(table) > 2 else []
        wrong = [row for row in table if len(row) != len(table[0])]
        begin = max((i for i in range(index) if HEADING.match(lines[i][1])), default=0)
        stop = next((i for i in range(index, len(lines)) if HEADING.match(lines[i][1])), len(lines))
        yield number, mark[1].split(), rows, wrong, "\n".join(text for _, text in lines[begin:stop])
