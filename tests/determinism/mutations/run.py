#!/usr/bin/env python3
"""The mutation suite: each small fault is noticed by whom of `pelt verify`, `pelt golden` and the unit tests must.

    run.py check                     every site of mutations.txt still stands in the sources, once
    run.py build  [--build DIR]      a copy of the tree with every mutant in it, built once
    run.py run    [--build DIR] [--shard I/N] [--only NAME]... [--detector verify|golden|tests]... [--results FILE]
    run.py table  FILE...            the counts of ../README.md, from one results file or of all shards

A variable chooses the mutant (mutation.hpp), so one build serves them all. `run` begins with the copy as it is, on
which every detector must pass, and asks of each mutant the detectors that its entry names as `seen`, or those given; a
results file that is there already is gone on with. Exit code 1 when one of them did not notice. Not part of the gate,
which only runs `check`.
"""

import argparse
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True  # beside the sources
import sites  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
SUITE = HERE / "mutations.txt"
# What is run on each mutant, cheapest first; a detector stops at its first failure.
VERIFY = ["bench/pelt", "verify", "--scene", "tiny", "--frames", "5", "--stop-at-failure"]
# A first look at what needs none of verify's checks: a twentieth of the time.
QUICK_VERIFY = [*VERIFY, "--no-checks"]
# What is wrong everywhere alike is the goldens' to see: a short look tells whether it is not.
SHORT_VERIFY = ["bench/pelt", "verify", "--scene", "tiny", "--frames", "2", "--isa", "avx2", "--no-skips",
                "--stop-at-failure"]
GOLDEN = [["bench/pelt", "golden", "--check", "{root}/traces/golden", "--scene", s]
          for s in ("tiny", "everything", "eyepet", "monster", "cast")]
# Test programs of the rooms a file belongs to, the likeliest first.
TESTS = {
    "core/kernels/": ["kernels", "jobs", "determinism"],
    "core/simd/": ["kernels", "jobs", "determinism"],
    "core/exact_math": ["character", "kernels"],
    "core/groom/": ["groom", "jobs", "determinism"],
    "core/": ["kernels", "jobs", "determinism"],
    "jobs/": ["jobs", "porting", "determinism", "model"],
    "platform_sim/": ["determinism"],
    "traces/": ["traces", "jobs", "determinism"],
    "bench/": ["command"],
}
# Reads the sources, where all mutants stand.
WITHOUT = "-Lanes.EveryQuestionToAGroupIsListed"
PROGRAMS = sorted({p for programs in TESTS.values() for p in programs})
# A mutant may hang: it is given what the unmutated copy took, many times over.
PATIENCE, LEAST_S = 4, 60


def fail(text):
    sys.exit(f"mutations: {text}")


def sources():
    """Every file of the tree that git knows or would know, from the root."""
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
                            check=True, capture_output=True).stdout
    return [name for name in listed.decode().split("\0") if name and (ROOT / name).is_file()]


def write_if_other(path, data):
    """So that a file that did not change is not built again."""
    if path.is_file() and path.read_bytes() == data:
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)


def copy_mutated(suite, target):
    mutated = sites.mutate(suite, ROOT)
    names = sources()
    for name in names:
        data = mutated[name].encode() if name in mutated else (ROOT / name).read_bytes()
        write_if_other(target / name, data)
    kept = set(names)
    for path in target.rglob("*"):
        if path.is_file() and str(path.relative_to(target)) not in kept:
            path.unlink()


def build(args, suite):
    source, binary = args.build / "source", args.build / "binary"
    copy_mutated(suite, source)
    header = source / HERE.relative_to(ROOT) / "mutation.hpp"
    targets = ["pelt"] + [f"pelt_{p}_test" for p in PROGRAMS]
    isas = ["-DPELT_ISAS=avx2"] if os.uname().machine == "x86_64" else []
    # Warnings are the sources' business, and mutants are odd on purpose.
    flags = f"-w -include {header}"
    subprocess.run(["cmake", "-S", source, "-B", binary, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=RelWithDebInfo",
                    "-DPELT_TEST_WIDE_KERNELS=OFF", f"-DCMAKE_CXX_FLAGS={flags}", *isas], check=True,
                   stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", binary, "--target", *targets, "--parallel", str(args.jobs)], check=True)


class Bench:
    """Runs the detectors on one mutant after the other."""

    def __init__(self, args):
        self.binary = args.build / "binary"
        self.limits = {}
        self.work = pathlib.Path(tempfile.mkdtemp(prefix="mutations."))

    def close(self):
        shutil.rmtree(self.work, ignore_errors=True)

    def command(self, name, words, number):
        """(caught, how, seconds) of one command."""
        reached = self.work / "reached"
        environment = dict(os.environ, PELT_MUTATION=str(number), PELT_MUTATION_REACHED=str(reached),
                           TMPDIR=str(self.work), TEST_TMPDIR=str(self.work))
        limit = self.limits.get(name, 3600.0) if number else 3600.0
        start = time.monotonic()
        process = subprocess.Popen(words, cwd=self.work, env=environment, stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT, start_new_session=True)
        try:
            output = process.communicate(timeout=limit)[0].decode(errors="replace")
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            return True, f"hangs ({limit:.0f} s)", time.monotonic() - start
        seconds = time.monotonic() - start
        if process.returncode == 0:
            return False, "", seconds
        return True, self.reason(process.returncode, output), seconds

    @staticmethod
    def reason(code, output):
        if code < 0:
            return f"signal {signal.Signals(-code).name}"
        lines = output.splitlines()
        for i, line in enumerate(lines):
            if line.startswith("[  FAILED  ]"):
                return line.split("]", 1)[1].split("(")[0].strip(" ,")
            if line.startswith("FAILED "):
                return " ".join(lines[i:i + 2])[:200]
            if "DIFFERENT" in line or line.startswith("pelt: "):
                return line[:200]
        return f"exit {code}"

    def steps(self, detector, programs, area, files):
        if detector == "verify":
            looks = [SHORT_VERIFY] if area == "other" else [QUICK_VERIFY, VERIFY]
            return [("verify", [str(self.binary / words[0]), *words[1:]]) for words in looks]
        if detector == "golden":
            return [(f"golden {g[-1]}", [str(self.binary / g[0]), *(w.format(root=ROOT) for w in g[1:])])
                    for g in GOLDEN]
        if detector != "tests":
            programs = [detector]
        else:
            programs = [f"{p}:{tests}" for p in programs for tests in likely_tests(p, files)] + [
                f"{p}:{WITHOUT}" for p in programs]
        return [(name, [str(self.binary / f"tests/pelt_{name}_test"), "--gtest_fail_fast", "--gtest_brief=1",
                     *([f"--gtest_filter={tests}"] if tests else [])])
                for p in programs for name, _, tests in [p.partition(":")]]

    def detect(self, detector, programs, number, area="", files=()):
        total = 0.0
        for name, words in self.steps(detector, programs, area, files):
            caught, how, seconds = self.command(name, words, number)
            total += seconds
            if number == 0:
                self.limits[name] = max(self.limits.get(name, LEAST_S), PATIENCE * seconds)
            if caught:
                return {"caught": True, "how": f"{name}: {how}" if detector != "verify" else how,
                        "seconds": round(total, 1)}
        return {"caught": False, "how": "", "seconds": round(total, 1)}

    def reached(self):
        path = self.work / "reached"
        found = path.exists()
        path.unlink(missing_ok=True)
        return found


def likely_tests(program, files):
    """The suites of the test files that share a word of their names with a mutated file: asked before all others."""
    words = {word for file in files for word in pathlib.Path(file).stem.split("_")}
    suites = set()
    for path in (ROOT / "tests" / program).glob("*_test.cpp"):
        if words & set(path.stem.split("_")[:-1]):
            suites |= set(re.findall(r"^(?:TYPED_)?TEST(?:_F|_P)?\((\w+),", path.read_text(), re.M))
    return [":".join(f"{s}.*:*/{s}.*:{s}/*" for s in sorted(suites)) + ":" + WITHOUT] if suites else []


def programs_of(mutation):
    out = []
    for site in mutation.sites:
        prefix = next(p for p in TESTS if site.file.startswith(p))
        out += [p for p in TESTS[prefix] if p not in out]
    return out


def read_results(path):
    """{(mutation, detector): result}"""
    results = {}
    if path.is_file():
        for line in path.read_text().splitlines():
            entry = json.loads(line)
            results[entry["name"], entry["detector"]] = entry
    return results


def run(args, suite):
    shard = [int(part) for part in args.shard.split("/")] if args.shard else [0, 1]
    if len(shard) != 2 or not 0 <= shard[0] < shard[1]:
        fail(f"--shard {args.shard}: not I/N with I from 0 to N - 1")
    wanted = [m for m in suite.mutations if not args.only or m.name in args.only]
    wanted = [m for m in wanted if m.number % shard[1] == shard[0]]
    results = read_results(args.results)
    bench = Bench(args)
    try:
        # Each way a detector is called: one that cannot even start would "catch" everything.
        asked = sorted({d for m in wanted for d in args.detector or m.seen})
        for detector, area in [(d, a) for d in asked for a in (("other", "") if d == "verify" else ("",))]:
            result = bench.detect(detector, PROGRAMS, 0, area)
            print(f"unmutated: {detector} {'FAILS: ' + result['how'] if result['caught'] else 'passes'}"
                  f" in {result['seconds']} s", flush=True)
            if result["caught"]:
                fail("the copy does not pass as it is; nothing can be distinguished from that")
        bench.reached()
        for mutation in wanted:
            for detector in args.detector or mutation.seen:
                if (mutation.name, detector) in results:
                    continue
                result = bench.detect(detector, programs_of(mutation), mutation.number, mutation.area,
                                      [site.file for site in mutation.sites])
                # A process that crashed or hung did not say so.
                result["reached"] = bench.reached() or result["caught"]
                with open(args.results, "a") as file:
                    file.write(json.dumps({"name": mutation.name, "detector": detector} | result) + "\n")
                print(f"{mutation.number:3} {mutation.area:11} {mutation.name}: {detector} "
                      f"{'caught' if result['caught'] else 'passes' if result['reached'] else 'never runs'} "
                      f"in {result['seconds']} s: {result['how']}", flush=True)
    finally:
        bench.close()
    if print_missed(wanted, args.detector, read_results(args.results)):
        sys.exit(1)


def must_see(mutation, detector):
    """Whether the mutation's entry names the detector; the unit tests, also one by name."""
    return any(s == detector or (detector == "tests" and ":" in s) for s in mutation.seen)


def table(args, suite):
    results = {}
    for path in args.files:
        for key, entry in read_results(path).items():
            if key in results:
                fail(f"{key[0]} is in more than one results file")
            results[key] = entry
    print("| area | mutations | " + " | ".join(sites.DETECTORS) + " |\n|---|---|---|---|---|")
    for area in sites.AREAS:
        of = [m for m in suite.mutations if m.area == area and m.seen]
        counts = [sum(must_see(m, d) for m in of) for d in sites.DETECTORS]
        print(f"| {area} | {len(of)} | {' | '.join(map(str, counts))} |")
    print_missed(suite.mutations, (), results)


def print_missed(mutations, detectors, results):
    """What was not noticed by whom must, or was not run; True where there is such a thing."""
    missed = False
    for m in mutations:
        for detector in [d for d in m.seen if not detectors or d in detectors]:
            entry = results.get((m.name, detector))
            if entry and entry["caught"]:
                continue
            missed = True
            print(f"{m.name}: {detector} {'was not run' if not entry else 'passes' if entry['reached'] else 'never runs it'}")
    return missed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("check")
    for name in ("build", "run"):
        sub = commands.add_parser(name)
        sub.add_argument("--build", type=pathlib.Path, default=ROOT / "build/mutations")
        if name == "build":
            sub.add_argument("--jobs", type=int, default=os.cpu_count())
        else:
            sub.add_argument("--shard", default="")
            sub.add_argument("--only", action="append", default=[])
            sub.add_argument("--detector", action="append", choices=sites.DETECTORS, default=[])
            sub.add_argument("--results", type=pathlib.Path)
    commands.add_parser("table").add_argument("files", type=pathlib.Path, nargs="+")
    args = parser.parse_args()
    try:
        suite = sites.read_suite(SUITE)
        if args.command == "check":
            sites.mutate(suite, ROOT)
            print(f"{len(suite.mutations)} mutations, every site stands once")
            return
        if args.command in ("build", "run"):
            args.build = args.build.resolve()
        if args.command == "run" and not args.results:
            args.results = args.build / "results.jsonl"
        {"build": build, "run": run, "table": table}[args.command](args, suite)
    except sites.SiteError as error:
        fail(error)


if __name__ == "__main__":
    main()
