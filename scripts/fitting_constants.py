#!/usr/bin/env python3
"""Writes docs/fitting_constants.md: the numeric constants of fitting/ with value, unit, meaning and source.

Usage: scripts/fitting_constants.py [--check]

The comment of a constant is beside it (`///<`) or above it (`///`), or both:

    constexpr double kSurface = 0.04;  ///< m in depth; farther neighbours are of another surface
    /// Cost from which the views disagree; 0.07 to 0.09 for correct takes (bench_depth_rigs 30 15 907).
    constexpr double kDisagree = 0.12;

1. It begins with the unit: a unit of UNITS, or a word of DIMENSIONLESS such as "share", "factor" or "of the extent:".
   The unit may also be the end of the name (kStep_s). Integers without a unit are counts.
2. The meaning follows.
3. "Source: ..." ends the comment: a program, measured data, a paper or a standard. Programs of tests/ that a comment
   names are its source without that word. A comment `//` directly above a group of constants gives the source of each.
4. "(numerical)" ends the comment of a pure technicality: iteration limit, tolerance, sample size, search grid,
   sentinel, identity of mathematics or units, fewest views that a method needs.

Constants without source are listed as not measured. With --check nothing is written; exit code 1 when the page differs
from the code, a comment lacks unit or meaning, or a program named as source does not exist.
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "fitting_constants.md"

# As written in comments: as listed on the page.
UNITS = {
    "m": "m", "metres": "m", "m^2": "m^2", "m/s": "m/s", "s": "s", "seconds": "s", "rad": "rad", "radians": "rad",
    "rad^2": "rad^2", "degrees": "degrees", "px": "px", "pixels": "px", "m and rad": "m and rad",
    "standard deviations": "standard deviations", "extents per second": "extents per second",
    "standard deviations and log scale": "standard deviations, log scale",
}
# First words of a number without dimension: as listed on the page.
DIMENSIONLESS = {word: word for word in (
    "share", "ratio", "factor", "weight", "sine", "cosine", "confidence", "cost", "loss", "log ratio", "log scale",
    "autocorrelation", "exponent", "chi square", "length of the mean normal", "number",
)}
DIMENSIONLESS.update({"factors": "factor", "times": "factor", "relative": "share", "scale": "factor", "step": "factor"})
# Things that an integer counts, and numbers of them in floating point.
COUNTED = (
    "bones|cameras|clips|clouds|detections|draws|fits|frames|groups|headings|hypotheses|joints|keypoints|lengths|"
    "matchings|moments|pairs|parts|points|poses|rounds|samples|scales|spans|stances|starts|steps|trials|views|voxels|"
    "walls")
NAME_UNITS = {"_s": "s", "_m": "m", "_px": "px"}
INTEGER = r"int|unsigned|long|std::(?:size_t|u?int\d+_t)"
NUMBER = rf"double|float|{INTEGER}"
DEFINITION = re.compile(
    r"^\s*(?:(?:static|inline) )*(constexpr|const) "
    rf"(?P<type>{NUMBER}|auto|Eigen::\w+|std::pair<[^;={{]*>|std::array<[^;={{]*>|[A-Z]\w*) "
    r"(?P<name>\w+)(?:\[\w*\])? ?(?P<start>=|\{)")
PROGRAMS = re.compile(r"bench_\w+|\b[a-z]\w*_test\b")
MEASURED = re.compile(r"bench_|_test\b|synthe|studio|recorded|clips|takes|trials|stills|fits|docs/")


class Constant:
    def __init__(self, path, line, kind, name, value, comment, group):
        self.path, self.line, self.name, self.value = path, line, name, value
        self.integer = re.fullmatch(INTEGER, kind) is not None or re.match(rf"std::array<(?:{INTEGER}),", kind)
        self.read(comment, group)

    def read(self, comment, group):
        """Splits a comment into unit, meaning and source."""
        comment = re.sub(r"\s+", " ", comment).strip()
        self.numerical = re.search(r" ?\(numerical\)", comment) is not None
        comment = re.sub(r" ?\(numerical\)", "", comment)
        comment, _, source = comment.partition("Source: ")
        group_source = group.partition("Source: ")[2]
        if not source:
            programs = re.findall(r"`([^`]*)`|\(((?:bench_)[^()]*)\)|(\w+_test\b)", comment)
            named = [text for match in programs for text in match if PROGRAMS.search(text) or "synthesize" in text]
            source = "; ".join(named)
        self.source = (source or group_source).strip().rstrip(".")
        self.unit, self.meaning = self.unit_of(comment.strip())
        self.kind = ("numerical" if self.numerical else "not measured" if not self.source else
                     "measured" if MEASURED.search(self.source) else "paper or standard")

    def unit_of(self, comment):
        lower = comment[:1].lower() + comment[1:]
        for unit in sorted(UNITS, key=len, reverse=True):
            found = re.match(rf"{re.escape(unit)}(?:[;,:.] ?| |$)", lower)
            if found:
                return UNITS[unit], lower[found.end():].strip()
        for ending, unit in NAME_UNITS.items():
            if self.name.endswith(ending):
                return unit, comment
        relative = re.match(r"(of [^:;,]+): (.+)", lower)
        if relative:
            return relative.group(1), relative.group(2)
        words = re.sub(r"^((small|larg|low|high|great)est|least|mean|cap on the) ", "", lower)
        for word in sorted(DIMENSIONLESS, key=len, reverse=True):
            if re.match(rf"{word}\b", words):
                return DIMENSIONLESS[word], re.sub(rf"^{word}[;,] ", "", lower)
        counted = re.match(rf"(?:\w+ly spaced |[a-z]+est |most |least |initial |latest |known |observed |sampled )*"
                           rf"({COUNTED})\b", lower)
        if counted:
            return counted.group(1), re.sub(rf"^({COUNTED})[;,] ", "", lower)
        if lower.startswith("of ") and not self.integer:
            return "share", comment
        return ("count" if self.integer else ""), comment

    def fault(self):
        where = f"{self.path}:{self.line}: {self.name}"
        if not self.meaning:
            return f"{where}: no meaning beside the constant; write its unit and meaning as `///< m; ...`"
        if not self.unit:
            return f"{where}: the comment begins with no unit; begin it with one of scripts/fitting_constants.py"
        unknown = [name for name in PROGRAMS.findall(self.source) if not program_exists(name)]
        if unknown:
            return f"{where}: the source {unknown[0]} is no program of tests/; name one that exists"
        return None


def program_exists(name, found={}):
    if name not in found:
        source = f"benchmarks/{name[len('bench_'):]}.cpp" if name.startswith("bench_") else f"**/{name}.cpp"
        found[name] = any((ROOT / "tests").glob(source))
    return found[name]


def comment_of(line):
    """Text of the comment of a line, and whether the line has code before it."""
    code, mark, text = line.partition("//")
    return (text.lstrip("/").lstrip("<").strip() if mark else None), code


def constants_of(path):
    lines = (ROOT / path).read_text(encoding="utf-8").split("\n")
    found, group, after = [], "", -1
    at = 0
    while at < len(lines):
        definition = DEFINITION.match(lines[at])
        if not definition or re.fullmatch(r"(?:const )?char\b.*", definition["type"]):
            text, code = comment_of(lines[at])
            if not lines[at].strip():
                group = ""
            elif text is not None and not code.strip() and re.match(r"\s*// ", lines[at]):
                group = ("" if at == after else group) + " " + text
            at += 1
            continue
        above, before = [], at - 1
        while before >= 0 and re.match(r"\s*///(?!<)", lines[before]):
            above.insert(0, comment_of(lines[before])[0])
            before -= 1
        line, beside, code = at, [], ""
        while True:
            text, part = comment_of(lines[at])
            code += " " + part.strip()
            if text is not None:
                beside.append(text)
            at += 1
            if ";" in part:
                break
        indent = lines[at - 1].find("//")
        while at < len(lines) and beside and (re.match(r"\s*///<", lines[at]) or
                                              re.match(rf"\s{{{max(indent, 9)}}}// ", lines[at])):
            beside.append(comment_of(lines[at])[0])
            at += 1
        name, after = definition["name"], at
        if not re.match(r"k[A-Z]", name) and not re.search(r"\bconstexpr\b", code):
            continue
        value = re.sub(r"\s+", " ", code[code.index(name) + len(name):])
        value = re.sub(r"^(\[\w*\])? ?=? ?|;\s*$", "", value).strip()
        if '"' in value and not re.search(r"\d", re.sub(r'"[^"]*"', "", value)):
            continue  # texts
        if not re.search(r"\d|infinity|\bk[A-Z]", value):
            continue  # enumerators
        # The unit stands beside the constant where it has two comments.
        comment = " ".join(beside + above)
        found.append(Constant(path, line + 1, definition["type"], name, value, comment, group))
    return found


def page_of(constants):
    kinds = {"measured": 0, "paper or standard": 0, "numerical": 0, "not measured": 0}
    for constant in constants:
        kinds[constant.kind] += 1
    text = [
        "# Constants of the fits", "",
        "Written by `scripts/fitting_constants.py` from the comments in `fitting/`. Its `--check`, which",
        "`scripts/format.sh --check` runs, fails where this page and the code differ. Options are not listed here:",
        "`mocurate config reference` has their units, defaults and ranges.", "",
        f"{len(constants)} constants:", "",
        "| kind | constants | source column |", "|---|---|---|",
        f"| measured | {kinds['measured']} | program with its arguments, test, or data |",
        f"| from a paper or standard | {kinds['paper or standard']} | reference |",
        f"| numerical (limit, tolerance, sample size, grid, sentinel, identity) | {kinds['numerical']} | - |",
        f"| not measured | {kinds['not measured']} | not measured |",
    ]
    folder = None
    for constant in sorted(constants, key=lambda c: (str(pathlib.PurePath(c.path).parent), c.path, c.line)):
        parent, name = str(pathlib.PurePath(constant.path).parent), pathlib.PurePath(constant.path).name
        if parent != folder:
            folder = parent
            text += ["", f"## {folder}", "", "| file | constant | value | unit | meaning | source |",
                     "|---|---|---|---|---|---|"]
        source = {"numerical": "-", "not measured": "not measured"}.get(constant.kind, constant.source)
        cells = [name, f"`{constant.name}`", f"`{constant.value}`", constant.unit, sentence(constant.meaning), source]
        text.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(text) + "\n"


def sentence(meaning):
    meaning = meaning.strip().rstrip(".;,")
    return meaning[:1].upper() + meaning[1:]


def main():
    arguments = sys.argv[1:]
    if arguments not in ([], ["--check"]):
        sys.exit(__doc__)
    files = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "fitting"], cwd=ROOT, capture_output=True,
                           check=True, text=True).stdout.split("\n")
    files = sorted(f for f in set(files) if re.search(r"\.(cpp|h)$", f) and (ROOT / f).exists())
    constants = [constant for path in files for constant in constants_of(path)]
    faults = [fault for fault in (constant.fault() for constant in constants) if fault]
    for fault in faults:
        print(fault, file=sys.stderr)
    page = page_of(constants)
    if not arguments:
        PAGE.write_text(page, encoding="utf-8")
    elif not PAGE.exists() or PAGE.read_text(encoding="utf-8") != page:
        print(f"{PAGE.relative_to(ROOT)}: differs from the constants of fitting/; run scripts/fitting_constants.py",
              file=sys.stderr)
        faults.append("page")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
