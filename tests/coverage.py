# SPDX-License-Identifier: Apache-2.0
"""coverage.py REPORT ROOT: prints the tables of tests/coverage.sh from the JSON of gcovr."""
import collections
import json
import pathlib
import re
import sys

LINES, BRANCHES = 95.0, 85.0
PARSERS = ("lib/formats/", "lib/io/", "lib/image/", "lib/glass/glass_table")
# Such code is compiled once per call and instruction set. The branches of all copies are counted separately.
COPIED = re.compile(r"PETZVAL_(INLINE|LOOPS)\b")
ERROR = re.compile(r"\bthrow\b|\b(refuse|fail|reject|error)[a-z_]*\(|\.warn\(")


def share(part, whole):
    return 100.0 * part / whole if whole else 100.0


report, root = json.load(open(sys.argv[1])), pathlib.Path(sys.argv[2])
modules = collections.defaultdict(lambda: [0, 0, 0, 0])
copied = [0, 0, 0, 0]
errors, unseen = 0, []
for file in report["files"]:
    name = file["file"]
    text = (root / name).read_text().splitlines()
    copies = any(COPIED.search(line) for line in text)
    module = modules[name.split("/")[-2] if name.count("/") > 1 else name]
    for line in file["lines"]:
        if line.get("gcovr/noncode"):
            continue
        branches = line["branches"]
        module[0] += 1
        module[1] += line["count"] > 0
        counted = copied if copies else module
        counted[2] += len(branches)
        counted[3] += sum(branch["count"] > 0 for branch in branches)
        if name.startswith(PARSERS) and ERROR.search(text[line["line_number"] - 1]):
            errors += 1
            if line["count"] == 0:
                unseen.append(f"{name}:{line['line_number']}: {text[line['line_number'] - 1].strip()}")

print("| module | lines | covered | branches | covered |\n|---|---|---|---|---|")
for name, (lines, seen, branches, taken) in sorted(modules.items()):
    print(f"| {name} | {lines} | {share(seen, lines):.1f} % | {branches} | {share(taken, branches):.1f} % |")
lines, seen, branches, taken = (sum(m[i] for m in modules.values()) for i in range(4))
print(f"| all | {lines} | {share(seen, lines):.2f} % | {branches} | {share(taken, branches):.2f} % |")
print(f"\nBranches of copied code: {copied[2]}, {share(copied[3], copied[2]):.1f} % taken")
print(f"Lines of importers that report an error: {errors}, {errors - len(unseen)} of them run")
for line in unseen:
    print("  " + line)
if share(seen, lines) < LINES or share(taken, branches) < BRANCHES or unseen:
    sys.exit(f"wanted {LINES:g} % of lines, {BRANCHES:g} % of branches and every error")
