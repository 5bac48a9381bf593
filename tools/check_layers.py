#!/usr/bin/python3
"""Checks that the house stands as docs/conventions.md says: levels, includes, sizes.

A header is public if its folder's CMakeLists.txt lists it under HEADERS, else private to its folder.

    tools/check_layers.py [--root FOLDER]

Exit codes: 0 nothing found, 1 something found (file:line: message), 2 wrong use.
"""

import argparse
import re
import sys
from pathlib import Path

# A folder of src/tandem includes only folders of a lower level, never sideways or up.
LEVELS = {
    "core": 0,
    "math": 1,
    "geometry": 2,
    "robot": 3,
    "world": 4,
    "motion": 4,
    "collision": 5,
    "trajectory": 5,
    "fitting": 5,
    "planning": 6,
    "shortening": 6,
    "control": 6,
    "coordination": 7,
    "sim": 7,
    "pipeline": 8,
    "verification": 8,
    "io": 9,
    "server": 9,
}
# Components of their own: they see what their folder sees and the folder itself; only those named
# here see them.
OPTIONAL = {
    "collision/fcl": {"pipeline", "verification"},
    "planning/ompl": {"pipeline", "verification"},
    "trajectory/nlopt": {"pipeline", "verification"},
    "shortening/nlopt": {"pipeline"},
}
# Headers directly in src/tandem, above every folder.
FACE = "tandem.h"

SOURCE_FOLDERS = ("src", "apps", "examples", "benchmarks", "fuzz", "tests")
HEADER_LINES = 300  # Each file and function stays below its number.
SOURCE_LINES = 600
FUNCTION_LINES = 60

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
STANDARD = re.compile(r"^[a-z_0-9]+$")
EIGEN = re.compile(r"^(unsupported/)?Eigen/")


class Findings:
    def __init__(self, root):
        self.root = root
        self.lines = []

    def add(self, path, line, message):
        self.lines.append((str(path.relative_to(self.root)), line, message))


def component_of(relative):
    """Component that a path below src/tandem belongs to, or None: 'collision', 'collision/fcl'."""
    parts = relative.split("/")
    if len(parts) == 1:
        return FACE if parts[0] == FACE else None
    if len(parts) > 2 and f"{parts[0]}/{parts[1]}" in OPTIONAL:
        return f"{parts[0]}/{parts[1]}"
    return parts[0] if len(parts) == 2 and parts[0] in LEVELS else None


def level_of(component):
    return max(LEVELS.values()) + 1 if component == FACE else LEVELS[component.split("/")[0]]


def objection(user, used):
    """Why component `user` may not include component `used`, or ''."""
    if user == used:
        return ""
    if used in OPTIONAL:
        if user.split("/")[0] in OPTIONAL[used]:
            return ""
        return f"{used} is optional: only {' and '.join(sorted(OPTIONAL[used]))} may include it"
    if used == FACE:
        return f"{FACE} is for programs: a folder includes what it uses"
    if user in OPTIONAL and user.split("/")[0] == used:
        return ""
    if level_of(used) < level_of(user):
        return ""
    way = "up" if level_of(used) > level_of(user) else "sideways"
    return (f"{user} (level {level_of(user)}) includes {way}: {used} is level {level_of(used)}; "
            "include only lower levels")


def blank(match):
    """As many lines as before, without their text."""
    return re.sub(r"[^\n]", " ", match.group(0))


NOT_CODE = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"(?P<mark>[^()\s\\"]{0,16})\(.*?\)(?P=mark)"'
    r'|"(?:\\.|[^"\\\n])*"|(?<![0-9a-zA-Z_])\'(?:\\.|[^\'\\\n])+\'', re.S)
DIRECTIVE = re.compile(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", re.M)
SCOPE = re.compile(r"\b(namespace|class|struct|union|enum|extern)\b")


def head_kind(head):
    """What the brace after `head` opens: 'scope', 'function' or 'value'."""
    bare = head
    while re.search(r"\([^()]*\)", bare):
        bare = re.sub(r"\([^()]*\)", " @ ", bare)
    while re.search(r"<[^<>]*>", bare):
        bare = re.sub(r"<[^<>]*>", " ", bare)
    if SCOPE.search(bare) and "=" not in bare:
        return "scope"
    if re.search(r"@[^:]*(?<!:):(?!:).*[\w>]\s*$", bare, re.S):
        return "value"  # Of a member, in a constructor's initialiser list.
    return "function" if "@" in bare or "operator" in bare else "value"


def functions(text):
    """First line, last line and name of every function body outside of functions."""
    code = DIRECTIVE.sub(blank, NOT_CODE.sub(blank, text))
    stack, found, start, parens, line = [], [], None, 0, 1
    head = []
    for char in code:
        if char == "\n":
            line += 1
        inside = any(kind != "scope" for kind, _, _ in stack)
        if char == "{":
            kind = "value" if inside or parens else head_kind("".join(head))
            stack.append((kind, start or line, "".join(head)))
            if kind == "scope":
                head, start = [], None
            continue
        if char == "}" and stack:
            kind, first, text_before = stack.pop()
            if kind == "function":
                found.append((first, line, " ".join(text_before.split())))
            if kind != "value":
                head, start = [], None
            elif not any(outer != "scope" for outer, _, _ in stack):
                head.append("()")
            continue
        if inside:
            continue
        parens += {"(": 1, ")": -1}.get(char, 0)
        if char == ";" and not parens:
            head, start = [], None
        elif char == ":" and "".join(head).strip() in ("public", "private", "protected"):
            head, start = [], None
        else:
            if start is None and not char.isspace():
                start = line
            head.append(char)
    return found


def name_of(head):
    """The word before the parameter list: for messages only."""
    match = re.search(r"([\w:~]+|operator\W+)\s*\(", head)
    name = match.group(1).strip() if match else head[:40]
    if name.startswith("TEST"):
        return head[match.start():].split(")")[0] + ")"
    return name


def check_sizes(path, text, findings):
    count = len(text.splitlines())
    limit = HEADER_LINES if path.suffix == ".h" else SOURCE_LINES
    if count >= limit:
        findings.add(path, count, f"{count} lines: stay under {limit}; look for the second thing "
                                  "it does and move that to a file of its own")
    for first, last, head in functions(text):
        length = last - first + 1
        if length >= FUNCTION_LINES:
            findings.add(path, first, f"{name_of(head)} has {length} lines: stay under "
                                      f"{FUNCTION_LINES}; give its parts names")


def listed_files(folder):
    """Names in HEADERS and in SOURCES of the tandem_module calls of a folder, and the face."""
    headers, sources = {FACE}, set()
    for lists in (folder / "CMakeLists.txt", folder.parent / "CMakeLists.txt"):
        if not lists.exists():
            continue
        text = re.sub(r"#[^\n]*", "", lists.read_text())
        for call in re.findall(r"tandem_module\(([^)]*)\)", text):
            words, mode, where = call.split(), "", ""
            rows = {"HEADERS": [], "SOURCES": [], "FOLDER": [], "NAME": []}
            for word in words:
                if re.fullmatch(r"[A-Z_]+", word):
                    mode = word
                else:
                    rows.setdefault(mode, []).append(word)
            where = (rows["FOLDER"] or rows["NAME"] or [""])[0]
            if folder.as_posix().endswith("src/tandem/" + where):
                headers.update(rows["HEADERS"])
                sources.update(rows["SOURCES"])
    return headers, sources


def check_include(path, number, include, context, findings):
    """One include line of a file below src/tandem."""
    component, public, base, public_headers = context
    bracket, target = include
    if not target.startswith("tandem/"):
        if bracket == '"':
            findings.add(path, number, f'"{target}": write the path from src: "tandem/..."')
        elif public and not STANDARD.match(target) and not EIGEN.match(target):
            findings.add(path, number, f"<{target}> in a public header: only std, Eigen and tandem; "
                                       "move it to the .cpp, or hide it behind a pointer")
        return
    relative = target[len("tandem/"):]
    used = component_of(relative)
    if used is None or not (base / relative).exists():
        findings.add(path, number, f'"{target}" does not exist in a known folder')
        return
    reason = objection(component, used)
    if reason:
        findings.add(path, number, reason)
    elif relative.endswith(".h") and relative not in public_headers and (
            public or used not in (component, component.split("/")[0])):
        findings.add(path, number, f'"{target}" is private to its folder: list it under HEADERS of '
                                   "its CMakeLists.txt, or do not include it here")


def check_module_file(path, text, base, lists, public_headers, findings):
    """Level, listing and includes of one file below src/tandem."""
    relative = path.relative_to(base).as_posix()
    component = component_of(relative)
    if component is None:
        findings.add(path, 1, "in a folder that tools/check_layers.py does not know: give it a level "
                              "there, or move the file")
        return
    if path.suffix == ".cpp" and path.name not in lists(path.parent)[1]:
        findings.add(path, 1, "not built: add it to SOURCES of its folder's CMakeLists.txt")
    context = (component, relative in public_headers, base, public_headers)
    for number, line in enumerate(text.splitlines(), 1):
        include = INCLUDE.match(line)
        if include:
            check_include(path, number, include.groups(), context, findings)


def check(root):
    findings = Findings(root)
    base = root / "src" / "tandem"
    if not base.is_dir():
        print(f"check_layers.py: no src/tandem in {root}", file=sys.stderr)
        sys.exit(2)
    cache = {}

    def lists(folder):
        if folder not in cache:
            cache[folder] = listed_files(folder)
        return cache[folder]

    public_headers = {p.relative_to(base).as_posix() for p in base.rglob("*.h")
                      if p.name in lists(p.parent)[0]}
    for name in SOURCE_FOLDERS:
        for path in sorted((root / name).rglob("*")):
            if path.suffix not in (".h", ".cpp"):
                continue
            text = path.read_text()
            check_sizes(path, text, findings)
            if base in path.parents:
                check_module_file(path, text, base, lists, public_headers, findings)
    return findings.lines


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parent.parent,
                        help="repository to check (default: the one this script is in)")
    lines = check(parser.parse_args().root.resolve())
    for path, line, message in lines:
        print(f"{path}:{line}: {message}")
    print(f"check_layers: {len(lines)} finding{'' if len(lines) == 1 else 's'}")
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main())
