"""Where the mutations of mutations.txt go in the sources, and the text with all of them in.

Every mutation is one or more sites: a file, the exact text that stands there (`at`; inside the longer text `within`
where it is not alone) and what takes its place (`be`). The mutated copy holds both, and a number chooses:

    expression   (PeltMutated(7) ? (be) : (at))
    statement    if (PeltMutated(7)) { be } else { at }

Mutations of one and the same `at` become one chain. What breaks if ignored: a site that stands twice or no more, or
that overlaps another, would silently mutate something else; it is an error.
"""

import pathlib
import re
from dataclasses import dataclass, field

AREAS = ("determinism", "skips", "access", "other")
# Besides these a mutation may name the test that must notice it, as "jobs:CallOrder.*".
DETECTORS = ("verify", "golden", "tests")


# Begins or ends what is no expression.
OPEN_ENDED = re.compile(r"^(if|for|while|return|case)\b|^[.?:,]|(?<!\+)\+$|(?<!-)-$|[&|*/,=<?:]$")


class SiteError(Exception):
    pass


@dataclass
class Site:
    file: str
    within: str = ""
    at: str = ""
    be: str = ""

    @property
    def form(self) -> str:
        return "statement" if self.ends() <= {";", "}", ""} else "expression"

    def ends(self) -> set[str]:
        return {text.rstrip()[-1:] for text in (self.at, self.be)}

    def fault(self) -> str:
        """Why its texts cannot take each other's place: a suite that does not compile proves nothing."""
        if self.at == self.be:
            return "nothing is changed"
        balanced = all(t.count(a) == t.count(b) for t in (self.at, self.be) for a, b in ("()", "[]", "{}"))
        whole = balanced and (self.form == "statement" or not (
            self.ends() & {";", ""} or any(OPEN_ENDED.search(text.strip()) for text in (self.at, self.be))))
        return "" if whole else f"not a whole {self.form}: {self.at.strip()} or {self.be.strip()}"


@dataclass
class Mutation:
    number: int
    name: str
    area: str
    seen: tuple[str, ...]  # the detectors that must notice it; none where no run can tell
    sites: list[Site] = field(default_factory=list)
    equivalent: str = ""  # why no run can tell


@dataclass
class Suite:
    mutations: list[Mutation] = field(default_factory=list)
    helpers: list[Site] = field(default_factory=list)  # code `be`, put in behind `at`


HEADER = re.compile(r"(\w+) ((?:\S*[^\s:] ?)+?): (.+)")


def read_suite(path: pathlib.Path) -> Suite:
    """The format stands at the head of mutations.txt."""
    suite, file, sites, last = Suite(), "", [], ""
    for number, line in enumerate(path.read_text().splitlines(), 1):
        mark, text = line[:1], line[2:]
        if mark in "#":  # or an empty line
            continue
        if line.startswith("== "):
            file, last = line[3:], ""
        elif mark in "@-+":
            if not last or "@-+".index(mark) < "@-+".index(last):
                sites.append(Site(file))
            part = {"@": "within", "-": "at", "+": "be"}[mark]
            setattr(sites[-1], part, getattr(sites[-1], part) + "\n" + text if mark == last else text)
            last = mark
        elif mark == "=":
            suite.mutations[-1].equivalent = f"{suite.mutations[-1].equivalent} {text}".strip()
        elif line == "helper":
            sites, last = suite.helpers, ""
        elif header := HEADER.fullmatch(line):
            area, seen, name = header.groups()
            seen = () if seen == "equivalent" else tuple(seen.split())
            suite.mutations.append(Mutation(len(suite.mutations) + 1, name, area, seen))
            sites, last = suite.mutations[-1].sites, ""
        else:
            raise SiteError(f"{path.name}:{number}: neither a head nor a site: {line}")
    check_suite(suite)
    return suite


def check_suite(suite: Suite):
    names = set()
    for mutation in suite.mutations:
        name = mutation.name
        if name in names:
            raise SiteError(f"{name}: the name is there twice")
        names.add(name)
        if mutation.area not in AREAS:
            raise SiteError(f"{name}: area '{mutation.area}' is none of {', '.join(AREAS)}")
        if bool(mutation.seen) == bool(mutation.equivalent) or any(
                s not in DETECTORS and ":" not in s for s in mutation.seen):
            raise SiteError(f"{name}: names {', '.join(DETECTORS)} or a test, or says why it is equivalent")
        if not mutation.sites:
            raise SiteError(f"{name}: no site")
        for site in mutation.sites:
            if fault := site.fault():
                raise SiteError(f"{name}: {site.file}: {fault}")


def find_once(text: str, part: str, where: str) -> int:
    count = text.count(part)
    if count != 1:
        raise SiteError(f"{where}: stands {count} times, not once: {part.strip().splitlines()[0]}")
    return text.index(part)


def place_of(site: Site, text: str, name: str) -> tuple[int, int]:
    where = f"{name}: {site.file}"
    if site.within:
        start = find_once(text, site.within, where)
        start += find_once(site.within, site.at, f"{where}, within")
    else:
        start = find_once(text, site.at, where)
    if site.form == "expression" and text[:start].endswith((".", "->", "::")):
        raise SiteError(f"{where}: a member of what stands before it is no expression: {site.at.strip()}")
    return start, start + len(site.at)


def chain(form: str, original: str, mutants: list[tuple[int, str]]) -> str:
    if form == "statement":
        out = ""
        for number, be in mutants:
            out += f"if (PeltMutated({number})) {{ {be} }} else "
        return out + "{ " + original + " }"
    out = original
    for number, be in reversed(mutants):
        out = f"(PeltMutated({number}) ? ({be}) : ({out}))"
    return out


def mutate(suite: Suite, root: pathlib.Path) -> dict[str, str]:
    """The text of every file that has a site, with all of its mutants in. Raises SiteError."""
    texts: dict[str, str] = {}
    groups: dict[str, dict[tuple[int, int], tuple[str, list[tuple[int, str]]]]] = {}

    def read(file: str, name: str) -> str:
        if file not in texts:
            path = root / file
            if not path.is_file():
                raise SiteError(f"{name}: no file {file}")
            texts[file] = path.read_text()
        return texts[file]

    for mutation in suite.mutations:
        for site in mutation.sites:
            text = read(site.file, mutation.name)
            place = place_of(site, text, mutation.name)
            mutants = groups.setdefault(site.file, {}).setdefault(place, (site.form, []))[1]
            mutants.append((mutation.number, site.be))
    edits: dict[str, list[tuple[int, int, str, str]]] = {}
    for file, places in groups.items():
        last_end, last = -1, ""
        for (start, end), (form, mutants) in sorted(places.items()):
            name = suite.mutations[mutants[0][0] - 1].name
            if start < last_end:
                raise SiteError(f"{file}: the sites of {last} and {name} overlap")
            last_end, last = end, name
            edits.setdefault(file, []).append((start, end, chain(form, texts[file][start:end], mutants), name))
    for helper in suite.helpers:
        text = read(helper.file, "helper")
        at = find_once(text, helper.at, f"helper: {helper.file}") + len(helper.at)
        edits.setdefault(helper.file, []).append((at, at, "\n" + helper.be, "helper"))
    out = {}
    for file, changes in edits.items():
        text = texts[file]
        for start, end, replacement, _ in sorted(changes, reverse=True):
            text = text[:start] + replacement + text[end:]
        out[file] = text
    return out
