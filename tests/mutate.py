# SPDX-License-Identifier: Apache-2.0
"""mutate.py ROOT COPY [options]: the mutation tests of tests/mutate.sh."""
import argparse
import collections
import difflib
import filecmp
import hashlib
import json
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import time

MODULES = ("trace", "pupil", "pupil_table", "focus", "polynomial", "camera", "iris", "blur")
OTHERS = ("analysis", "core", "figure", "io", "lens", "paraxial", "prescription")  # only with --modules
# Test programs that depend on these modules. Hashes of bits detect every change of rounding: they run last, and changes that only
# they detect are counted separately.
PROGRAMS = MODULES + ("lens", "paraxial", "analysis", "c", "bits")
LIBRARIES = ("petzval-core", "petzval-blur", "petzval-c", "petzval-figure", "petzval-fit", "petzval-image")
WANTED = 90.0  # per cent
QUICK = 0.5  # seconds: tests up to this time run first
LONGEST = 1.0  # seconds: longer tests of other modules do not run
MOST_OBJECTS = 150  # headers that more objects include are not changed
MEMORY = 16 << 30  # address space of a test program, bytes

OPERATORS = {"+": "-", "-": "+", "*": "/", "/": "*", "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*=", "&&": "||", "||": "&&"}
# < does not become !=, which has no effect in most loops.
COMPARISONS = {"<": ("<=", ">", ">=", "=="), "<=": ("<", ">", ">=", "=="), ">": (">=", "<", "<=", "=="),
               ">=": (">", "<", "<=", "=="), "==": ("!=", "<", ">"), "!=": ("==", "<", ">")}
HIDDEN = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|(?<!\w)\'(?:\\.|[^\'\\\n])*\'|^[ \t]*#(?:\\\n|[^\n])*', re.M | re.S)
# clang-format writes spaces around binary operators, but not around the brackets of templates and the marks of references.
BINARY = re.compile(r"(?<= )(\+=|-=|\*=|/=|<=|>=|==|!=|&&|\|\||[-+*/<>])(?=[ \n])")
NOT = re.compile(r"(?<=[\s(])!(?=[\w(])")
NUMBER = re.compile(r"(?<![\w.'])(\d+\.\d*(?:e[-+]?\d+)?|\d+(?:e[-+]?\d+)?)(?![\w.'])")
CONDITION = re.compile(r"\bif \(")
STATEMENT = re.compile(
    r"^ +(?!return\b|throw\b|using\b|delete\b)(?:[\w.:>\[\]()-]+ (?:[-+*/|&]?=) .*|[\w.:>\[\]-]+\(.*\));$", re.M)
# Statements about types and messages are not changed.
ASIDE = re.compile(r"\bstatic_assert\b|\bthrow\b|\bError\b|\busing\b|\boperator\b|\brequires\b|\bconcept\b|\benum\b|\btemplate\b"
                   r"|\bvirtual\b|\breserve\(|\bcase\b|@")

Mutant = collections.namedtuple("Mutant", "module file line before after text key")


def blank(match):
    """Replaces comments and strings by characters of the same number, so that positions stay."""
    sign = "@" if match.group().startswith('"') else " "  # ASIDE excludes statements with a message
    return "".join("\n" if c == "\n" else sign for c in match.group())


def closing(code, start, pair):
    depth = 0
    for i in range(start, len(code)):
        depth += (code[i] == pair[0]) - (code[i] == pair[1])
        if depth == 0:
            return i
    return -1


def without_template_arguments(code):
    """Blanks template arguments: <> directly after a name."""
    out = list(code)
    for match in re.finditer(r"(?<=\w)<(?=[\w:])|\btemplate <", code):
        start = match.end() - 1
        end = closing(code, start, "<>")
        if 0 < end < start + 200 and not re.search(r"[;{}]", code[start:end]):
            out[start:end + 1] = " " * (end + 1 - start)
    return "".join(out)


def places(module, name, text):
    """All positions of a file that may change: (start, end, replacements)."""
    code = without_template_arguments(HIDDEN.sub(blank, text))

    def aside(at):
        start = max(code.rfind(c, 0, at) for c in ";{}") + 1
        ends = [e for e in (code.find(c, at) for c in ";{}") if e >= 0]
        return ASIDE.search(code[start:min(ends, default=len(code))])

    found = []
    for match in BINARY.finditer(code):
        sign = match.group()
        found.append((match.start(), match.end(), COMPARISONS.get(sign) or (OPERATORS[sign],)))
    for match in NOT.finditer(code):
        found.append((match.start(), match.end(), [""]))
    for match in NUMBER.finditer(code):
        number = match.group()
        real = not number.isdigit()
        value = float(number) if real else int(number)
        others = {"0": 0, "1": 1, "2": 2, f"({number} + 1)": value + 1, **({"0.5": 0.5} if real else {})}
        if real:
            others = {k if k[0] == "(" or "." in k else k + ".0": v for k, v in others.items()}
        elif value < 2:
            others.pop(f"({number} + 1)")
        found.append((match.start(), match.end(), [k for k, v in others.items() if v != value]))
    for match in CONDITION.finditer(code):
        end = closing(code, match.end() - 1, "()")
        condition = text[match.end():end]
        if not re.search(r";|[^=!<>]=[^=]", condition):
            found.append((match.end(), end, [f"!({condition})"]))
    for match in STATEMENT.finditer(code):
        before = code[:match.start()].rstrip()
        if before.endswith((";", "{", "}", ")", "else")) and code.count("(", match.start(), match.end()) == code.count(
                ")", match.start(), match.end()):
            first = match.start() + len(match.group()) - len(match.group().lstrip())
            found.append((first, match.end(), [";"]))
    return [place for place in found if not aside(place[0])]


def mutant(module, name, text, place, chance):
    start, end, others = place
    after = text[:start] + chance.choice(others) + text[end:]
    first, last = text.rfind("\n", 0, start) + 1, text.find("\n", end)
    before, changed = text[first:last], after[first:last + len(after) - len(text)]
    alike = [match.start() for match in re.finditer(rf"^{re.escape(before)}$", text, re.M)]
    which = name if len(alike) == 1 else f"{name}#{alike.index(first) + 1}"
    return Mutant(module, name, text.count("\n", 0, start) + 1, before, changed, after,
                  key(which, before.splitlines(), changed.splitlines()))


def read_equivalent(path):
    """Blocks between blank lines: the file, - lines, + lines, and the reason in indented lines. file#2: the second of several
    equal lines."""
    known = {}
    for block in re.split(r"\n\s*\n", path.read_text()):
        lines = [line for line in block.splitlines() if line and not line.startswith("#")]
        if not lines:
            continue
        before = [line[1:].strip() for line in lines[1:] if line.startswith("-")]
        after = [line[1:].strip() for line in lines[1:] if line.startswith("+")]
        reason = " ".join(line.strip() for line in lines[1:] if line.startswith(" "))
        if not (before and after and reason):
            sys.exit(f"{path}: block =\n{block}\nmust be a file, lines with - and +, and a reason")
        known[key(lines[0], before, after)] = reason
    return known


def key(file, before, after):
    return file.strip(), tuple(line.strip() for line in before), tuple(line.strip() for line in after)


def copy_tree(root, copy):
    """Copies tracked and new files; equal files keep their times, so that they are not compiled again."""
    names = subprocess.run(["git", "-C", root, "ls-files", "-z", "--cached", "--others", "--exclude-standard"], check=True,
                           capture_output=True, text=True).stdout.split("\0")
    for name in filter(None, names):
        if (root / name).is_file() and not ((copy / name).is_file() and filecmp.cmp(root / name, copy / name, shallow=False)):
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(root / name, copy / name)


class Tests:
    def __init__(self, copy, jobs, modules):
        self.copy, self.build, self.jobs = copy, copy / "build", jobs
        self.programs = PROGRAMS + tuple(sorted(set(modules) - set(PROGRAMS)))
        # The restored source of a change was compiled before: a cache saves time.
        launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
        subprocess.run(["cmake", "-S", copy, "-B", self.build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                        "-DBUILD_SHARED_LIBS=ON", "-DPETZVAL_BUILD_EXAMPLES=OFF", "-DCMAKE_LINK_DEPENDS_NO_SHARED=ON", *launcher],
                       check=True, stdout=subprocess.DEVNULL)
        if not self.make([*LIBRARIES, *(f"{p}_tests" for p in self.programs)], quiet=False):
            sys.exit("the tests do not build")
        self.objects = collections.Counter()
        deps = subprocess.run(["ninja", "-C", self.build, "-t", "deps"], check=True, capture_output=True, text=True).stdout
        for line in deps.splitlines():
            if line.startswith("    "):
                self.objects[os.path.normpath(self.build / line.strip())] += 1
        self.seconds = {program: self.measured(program) for program in self.programs}

    def measured(self, program):
        """Seconds of each test of the unchanged program, measured again only if its files change."""
        made_of = hashlib.sha256()
        for folder in ("lib", "include", "data", f"tests/{program}"):
            for path in sorted((self.copy / folder).rglob("*.*")):
                made_of.update(path.read_bytes() if path.is_file() else b"")
        kept, told = self.build / f"{program}.kept", self.build / f"{program}.json"
        if not (kept.is_file() and kept.read_text() == made_of.hexdigest()):
            show(f"{program}_tests, unchanged")
            if not self.passes(program, "*", 3600, f"--gtest_output=json:{told}"):
                sys.exit(f"{program}_tests fails without a change")
            kept.write_text(made_of.hexdigest())
        return {f"{suite['name']}.{test['name']}": float(test["time"].rstrip("s"))
                for suite in json.loads(told.read_text())["testsuites"] for test in suite["testsuite"]}

    def rounds(self, module):
        """Programs with the tests to run: most likely and fastest tests first."""
        def some(program, wanted):
            names = [name for name, seconds in self.seconds[program].items() if wanted(seconds)]
            if names:
                yield program, ":".join(names), 20 + 5 * sum(self.seconds[program][name] for name in names)

        yield from some(module, lambda seconds: seconds <= QUICK)
        others = sorted(set(self.programs) - {module, "bits"}, key=lambda p: sum(self.seconds[p].values()))
        for program in others:
            yield from some(program, lambda seconds: seconds <= QUICK)
        yield from some(module, lambda seconds: seconds > QUICK)
        for program in others:
            yield from some(program, lambda seconds: QUICK < seconds <= LONGEST)
        yield from some("bits", lambda seconds: seconds <= LONGEST)

    def make(self, targets, quiet=True):
        silent = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL} if quiet else {}
        return subprocess.run(["ninja", "-C", self.build, "-j", str(self.jobs), *targets], check=False, **silent).returncode == 0

    def passes(self, program, names, limit, *arguments):
        """True if the tests pass within `limit` seconds."""
        process = subprocess.Popen(
            [self.build / "tests" / program / f"{program}_tests", "--gtest_fail_fast", f"--gtest_filter={names}", *arguments],
            cwd=self.build, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY)))
        try:
            return process.wait(limit) == 0
        except subprocess.TimeoutExpired:
            return False
        finally:
            try:
                os.killpg(process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
            process.wait()

    def killer(self, change):
        """The program that detects a change; "" if no program does, None if the change does not compile."""
        path = self.copy / change.file
        before = path.read_text()
        try:
            path.write_text(change.text)
            if not self.make(LIBRARIES):
                return None
            rounds = list(self.rounds(change.module))
            # Tests that compile the changed file themselves (headers and a few sources) run last.
            for own in (False, True) if self.objects[str(path)] > 1 else (False,):
                if own and not self.make([f"{change.module}_tests"]):
                    return change.module
                for program, names, limit in rounds:
                    show(f"{change.file}:{change.line} {program}_tests")
                    if (not own or program == change.module) and not self.passes(program, names, limit):
                        return program
            return ""
        finally:
            path.write_text(before)


def show(text):
    if sys.stderr.isatty():
        print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)


def say(text):
    show("")
    print(text, flush=True)


def diff(change):
    lines = difflib.unified_diff([change.before], [change.after], n=0, lineterm="")
    return f"{change.file}:{change.line}\n" + "\n".join(line for line in lines if not line.startswith(("---", "+++", "@@")))


def sample(root, modules, seed):
    """Changes of the modules in random order."""
    files = {}
    for module in modules:
        for path in sorted((root / "lib" / module).glob("*.[ch]pp")):
            files[path.relative_to(root).as_posix()] = module, path.read_text()
    all_places = [(name, place) for name, (module, text) in files.items() for place in places(module, name, text)]
    chance = random.Random(seed)
    chance.shuffle(all_places)
    say(f"seed {seed}: {len(all_places)} places in {len(files)} files of {', '.join(modules)}")
    for name, place in all_places:
        yield mutant(files[name][0], name, files[name][1], place, chance)


def main():
    parser = argparse.ArgumentParser(prog="tests/mutate.sh")
    parser.add_argument("root", type=pathlib.Path, help=argparse.SUPPRESS)
    parser.add_argument("copy", type=pathlib.Path, help=argparse.SUPPRESS)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--modules", type=lambda text: text.split(","), default=MODULES)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    options = parser.parse_args()
    for name in ("count", "jobs"):
        if getattr(options, name) < 1:
            parser.error(f"--{name} = {getattr(options, name)}; must be 1 or more")
    for module in options.modules:
        if module not in MODULES + OTHERS:
            parser.error(f"--modules = {module}; must be among {', '.join(MODULES + OTHERS)}")

    signal.signal(signal.SIGTERM, lambda *_: sys.exit("stopped"))  # the finally blocks restore the file and print the report
    known = read_equivalent(options.root / "tests" / "mutants.txt")
    copy_tree(options.root, options.copy)
    tests = Tests(options.copy, options.jobs, options.modules)
    counts, survivors, done = collections.defaultdict(collections.Counter), [], 0
    try:
        for change in sample(options.root, options.modules, options.seed):
            if done == options.count:
                break
            if tests.objects[str(options.copy / change.file)] > MOST_OBJECTS:
                continue
            start = time.monotonic()
            if change.key in known:
                fate = "equivalent"
            else:
                by = tests.killer(change)
                fate = "no code" if by is None else "survived" if not by else "by hashes" if by == "bits" else "killed"
            counts[change.module][fate] += 1
            if fate == "no code":
                continue
            done += 1
            by = f", by {by}_tests" if fate == "killed" else ""
            say(f"[{done}/{options.count}] {fate}{by}, {time.monotonic() - start:.0f} s: {diff(change)}")
            if fate == "survived":
                survivors.append(change)
    finally:
        report(counts, survivors)
        tests.make(LIBRARIES)  # builds the restored copy
    total = sum(counts.values(), collections.Counter())
    if score(total) < WANTED:
        sys.exit(f"score = {score(total):.1f} %; must be at least {WANTED:g} %")


def score(count):
    killed = count["killed"] + count["by hashes"]
    return 100.0 * killed / max(killed + count["survived"], 1)


def report(counts, survivors):
    say("\n| module | changes | noticed | by hashes of bits alone | not noticed | equivalent | score |")
    print("|---|---|---|---|---|---|---|")
    for module, c in [*sorted(counts.items()), ("all", sum(counts.values(), collections.Counter()))]:
        fates = [sum(c.values()) - c["no code"], c["killed"] + c["by hashes"], c["by hashes"], c["survived"], c["equivalent"]]
        print(f"| {module} | {' | '.join(str(fate) for fate in fates)} | {score(c):.1f} % |")
    if survivors:
        print("\nNot noticed:")
    for change in survivors:
        print(diff(change))


main()
