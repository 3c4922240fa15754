"""What of the frame's code no course of `pelt verify` runs: regions of core/kernels and jobs that were entered no time.

    coverage.py EXPORT.json SOURCE_DIR KNOWN.txt

EXPORT.json is what `llvm-cov export` says. A region is named by its file and the text of the line it begins in, so that
it is found again where lines have moved; what a compiler decides (constexpr, and the statement after it) is nothing a run
could enter. KNOWN.txt has those that remain, with why; one that is not there fails, and so does one that is there and is
run, or is gone.
"""
import json
import sys
from pathlib import Path

ROOMS = ("core/kernels/", "jobs/")
LINE, COLUMN, COUNT, HAS_COUNT, IS_ENTRY = range(5)
ALL = "*"


def find_decided(lines):
    """Of each line whether a compiler decides what begins there: clang counts no such branch of a template that some
    instantiation leaves out"""
    decided = []
    for number, line in enumerate(lines):
        goes_on = number > 0 and decided[-1] and not lines[number - 1].rstrip().endswith(("{", ";", "}"))
        decided.append("constexpr" in line or goes_on)
    return decided


def find_regions(export, source):
    """(file, text of a line in which some region begins that was never entered), of all rooms"""
    never = set()
    for file in export["data"][0]["files"]:
        path = Path(file["filename"]).resolve()
        if not path.is_relative_to(source) or not str(path.relative_to(source)).startswith(ROOMS):
            continue
        lines = path.read_text().split("\n")
        decided = find_decided(lines)
        for s in file["segments"]:
            text = lines[s[LINE] - 1].strip()
            if s[HAS_COUNT] and s[IS_ENTRY] and s[COUNT] == 0 and text not in ("", "}") and not decided[s[LINE] - 1]:
                never.add((str(path.relative_to(source)), text))
    return never


def read_known(path):
    """'# reason', then 'file: text of the line' for each; 'file: *' is all of a file that is no part of a frame"""
    known = set()
    for number, line in enumerate(Path(path).read_text().splitlines(), 1):
        if not line or line.startswith("#"):
            continue
        file, colon, text = line.partition(": ")
        if not colon:
            sys.exit(f"{path}:{number}: neither '# reason' nor 'file: line'")
        known.add((file, text))
    return known


def main():
    export, source, known_path = sys.argv[1:]
    never = find_regions(json.loads(Path(export).read_text()), Path(source).resolve())
    if not never:
        sys.exit("nothing of core/kernels or jobs is in the export")
    known = read_known(known_path)
    whole = {file for file, text in known if text == ALL}
    listed = never & known | {(file, ALL) for file, _ in never if file in whole}
    found = {(file, text) for file, text in never if file not in whole} - known
    for file, text in sorted(found):
        print(f"run by no course: {file}: {text}")
    for file, text in sorted(known - listed):
        print(f"listed, and it is run or is gone: {file}: {text}")
    print(f"{len(never)} lines begin what no course runs, {len(found)} of them are not listed")
    return 1 if found or known != listed else 0


sys.exit(main())
