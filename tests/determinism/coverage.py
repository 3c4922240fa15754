"""What of the frame's code no course of `pelt verify` runs: regions of core/kernels and jobs that were entered no time.

    coverage.py EXPORT.json SOURCE_DIR KNOWN.txt

EXPORT.json is what `llvm-cov export` says. A region is named by its file and the text of the line it begins in, so that
it is found again where lines have moved. KNOWN.txt has those that remain, with why; one that is not there fails, and so
does one that is there and is run, or is gone.
"""
import json
import sys
from pathlib import Path

ROOMS = ("core/kernels/", "jobs/")
LINE, COLUMN, COUNT, HAS_COUNT, IS_ENTRY = range(5)


def find_regions(export, source):
    """file -> text of a line -> whether some region that begins in it was never entered"""
    found = {}
    for file in export["data"][0]["files"]:
        path = Path(file["filename"])
        if not path.is_relative_to(source) or not str(path.relative_to(source)).startswith(ROOMS):
            continue
        lines = path.read_text().splitlines()
        never = {lines[s[LINE] - 1].strip() for s in file["segments"] if s[HAS_COUNT] and s[IS_ENTRY] and s[COUNT] == 0}
        found[str(path.relative_to(source))] = never - {"", "}"}
    return found


def read_known(path):
    """'# reason', then 'file: text of the line' for each; in any number of such groups"""
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
    found = find_regions(json.loads(Path(export).read_text()), Path(source).resolve())
    if not found:
        sys.exit("nothing of core/kernels or jobs is in the export")
    never = {(file, text) for file, texts in found.items() for text in texts}
    known = read_known(known_path)
    for file, text in sorted(never - known):
        print(f"run by no course: {file}: {text}")
    for file, text in sorted(known - never):
        print(f"listed, and it is run or is gone: {file}: {text}")
    print(f"{len(found)} files, {len(never)} lines begin what no course runs, {len(known)} of them listed")
    return 1 if never != known else 0


sys.exit(main())
