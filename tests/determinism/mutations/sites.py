"""Where the mutations of mutations.toml go in the sources, and the text with all of them in.

Every mutation is one or more sites: a file, the exact text that stands there (`at`; inside the longer text `within`
where it is not alone) and what takes its place (`be`). The mutated copy holds both, and a number chooses:

    expression   (PeltMutated(7) ? (be) : (at))
    statement    if (PeltMutated(7)) { be } else { at }

Mutations of one and the same `at` become one chain. What breaks if ignored: a site that stands twice or no more, or
that overlaps another, would silently mutate something else; it is an error.
"""

import pathlib
import tomllib
from dataclasses import dataclass, field

FORMS = ("expression", "statement")
AREAS = ("determinism", "skips", "access", "other")
# Besides these a mutation may name the test that must notice it, as "jobs:CallOrder.*".
DETECTORS = ("verify", "golden", "tests")


class SiteError(Exception):
    pass


@dataclass
class Site:
    file: str
    at: str
    be: str
    within: str = ""
    form: str = "expression"


@dataclass
class Mutation:
    number: int
    name: str
    area: str
    sites: list[Site]
    seen: tuple[str, ...]  # the detectors that must notice it
    equivalent: str = ""  # why no run can tell: then nobody must


@dataclass
class Helper:
    """Code that mutants of a file need, put in behind the text `after`."""

    file: str
    after: str
    code: str


@dataclass
class Suite:
    mutations: list[Mutation] = field(default_factory=list)
    helpers: list[Helper] = field(default_factory=list)


def read_suite(path: pathlib.Path) -> Suite:
    with open(path, "rb") as file:
        data = tomllib.load(file)
    suite = Suite()
    names = set()
    for number, entry in enumerate(data.get("mutation", []), 1):
        name = entry["name"]
        if name in names:
            raise SiteError(f"{name}: the name is there twice")
        names.add(name)
        if entry["area"] not in AREAS:
            raise SiteError(f"{name}: area '{entry['area']}' is none of {', '.join(AREAS)}")
        parts = entry.get("site", [entry])
        sites = [Site(p["file"], p["at"], p["be"], p.get("within", ""), p.get("form", "expression")) for p in parts]
        for site in sites:
            if site.form not in FORMS:
                raise SiteError(f"{name}: form '{site.form}' is none of {', '.join(FORMS)}")
            if not is_whole(site):
                raise SiteError(f"{name}: {site.file}: not a whole {site.form}: {site.at.strip()} or {site.be.strip()}")
            if site.at == site.be:
                raise SiteError(f"{name}: nothing is changed")
        seen, equivalent = tuple(entry.get("seen", ())), entry.get("equivalent", "")
        if bool(seen) == bool(equivalent) or any(s not in DETECTORS and ":" not in s for s in seen):
            raise SiteError(f"{name}: `seen` names {', '.join(DETECTORS)} or a test, or it is equivalent")
        suite.mutations.append(Mutation(number, name, entry["area"], sites, seen, equivalent))
    suite.helpers = [Helper(h["file"], h["after"], h["code"]) for h in data.get("helper", [])]
    return suite


def is_whole(site: Site) -> bool:
    """Whether its texts can stand in the form: a suite that does not compile proves nothing."""
    balanced = all(t.count(a) == t.count(b) for t in (site.at, site.be) for a, b in ("()", "[]", "{}"))
    ends = {t.rstrip()[-1:] for t in (site.at, site.be)}
    return balanced and (ends <= {";", "}", ""} if site.form == "statement" else "" not in ends and ";" not in ends)


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
        at = find_once(text, helper.after, f"helper: {helper.file}") + len(helper.after)
        edits.setdefault(helper.file, []).append((at, at, "\n" + helper.code, "helper"))
    out = {}
    for file, changes in edits.items():
        text = texts[file]
        for start, end, replacement, _ in sorted(changes, reverse=True):
            text = text[:start] + replacement + text[end:]
        out[file] = text
    return out
