#!/usr/bin/env python3
"""What pages quote of the command is what it prints.
  quotes.py PELT SOURCE_DIR      (in a folder where it may write)

A code block of a page, indented or fenced, that has a line "$ pelt ..." is run; what stands below, up to the next "$ " or
the block's end, must be lines of its output, one after the other. Blank lines, blanks at the end of a line and figures of
time ("3.1 ms") do not count. Every other "pelt SUBCOMMAND --option" in a code block must be one that there is.
"""
import os
import re
import shlex
import subprocess
import sys

TIME = re.compile(r'\b\d[\d.,]*(?= ?(?:ns|µs|ms|s|min|seconds|minutes)\b)')


def blocks(text):
    """(number of its first line, its lines) of each code block."""
    lines, at = text.split('\n'), 0
    while at < len(lines):
        begin = at
        if lines[at].startswith('```'):
            at += 1
            while at < len(lines) and not lines[at].startswith('```'):
                at += 1
            yield begin + 2, lines[begin + 1:at]
            at += 1
        elif lines[at].startswith('    ') and (at == 0 or not lines[at - 1].strip()):
            while at < len(lines) and (lines[at].startswith('    ') or not lines[at].strip()):
                at += 1
            yield begin + 1, [line[4:] for line in lines[begin:at]]
        else:
            at += 1


def plain(lines):
    return [TIME.sub('#', line.rstrip()) for line in lines if line.strip()]


def difference(quoted, printed):
    """Nothing when the one is a part of the other, else where they part."""
    quoted, printed = plain(quoted), plain(printed)
    if not quoted:
        return 'nothing is quoted'
    farthest, fault = -1, f"'{quoted[0]}' is not printed"
    for first in (i for i, line in enumerate(printed) if line == quoted[0]):
        rest = printed[first:first + len(quoted)] + [''] * len(quoted)
        same = next((i for i, (a, b) in enumerate(zip(quoted, rest)) if a != b), len(quoted))
        if same == len(quoted):
            return ''
        if same > farthest:
            farthest, fault = same, f"'{quoted[same]}' is quoted, '{rest[same]}' is printed"
    return fault


def quotes(lines):
    """(index of its line, arguments, what is quoted) of each command."""
    starts = [i for i, line in enumerate(lines) if line.startswith('$ ')]
    for start, end in zip(starts, starts[1:] + [len(lines)]):
        words = shlex.split(lines[start][2:], comments=True)
        if words[:1] == ['pelt']:
            yield start, words[1:], lines[start + 1:end]


def commands(lines):
    """(index of its line, subcommand, its long options) of each command that is only named."""
    for i, line in enumerate(lines):
        command = re.match(r'(?:.*[\s\'"/]|)pelt ([a-z]+)\b([^#|>;&]*)', line)
        if command:
            yield i, command[1], re.findall(r'(?<![\w-])--[a-z0-9-]+', command[2])


def pages(folder):
    for where, folders, files in os.walk(folder):
        folders[:] = [f for f in folders if f not in ('.git', 'build', 'shared')]
        for file in sorted(files):
            if file.endswith('.md'):
                yield os.path.join(where, file)


def check(pelt, source_dir):
    faults, quoted, named, helps = [], 0, 0, {}

    def run(*words):
        done = subprocess.run([pelt, *words], capture_output=True, text=True, stdin=subprocess.DEVNULL)
        return done.stdout

    for page in pages(source_dir):
        with open(page, encoding='utf-8') as file:
            text = file.read()
        for first, lines in blocks(text):
            place = os.path.relpath(page, source_dir)
            for at, words, below in quotes(lines):
                quoted += 1
                fault = difference(below, run(*words).split('\n'))
                if fault:
                    faults.append(f'{place}:{first + at}: pelt {" ".join(words)}: {fault}')
            for at, subcommand, options in commands(lines):
                if subcommand not in helps:
                    helps[subcommand] = run(subcommand, '--help-all')
                known = helps[subcommand]
                if subcommand == 'trace':  # its options are those of the subcommands below it
                    known = ''.join(run('trace', word, '--help-all') for word in ('record', 'replay', 'show'))
                named += 1
                faults += [f'{place}:{first + at}: pelt {subcommand} has no {option}' for option in options
                           if not re.search(re.escape(option) + r'(?![\w-])', known)]
    return faults, quoted, named


def self_test():
    page = 'text\n\n    $ pelt plan --x 1   # why\n    a  1\n    took 3.1 ms\n\n```text\n$ pelt two\nb\n```\n    no block'
    found = [q for _, lines in blocks(page) for q in quotes(lines)]
    assert [q[1] for q in found] == [['plan', '--x', '1'], ['two']], found
    assert difference(found[0][2], ['head', 'a  1 ', '', 'took 99 ms', 'tail']) == ''
    assert 'a  2' in difference(['a  2'], ['a  1'])
    assert "'took #" in difference(found[0][2], ['a  1', 'lost', 'took 3.1 ms'])
    assert list(commands(['x=1 build/pelt run --scene tiny # --no', 'pelts run --x'])) == [(0, 'run', ['--scene'])]


self_test()
found_faults, quote_count, named_count = check(sys.argv[1], sys.argv[2])
for found_fault in found_faults:
    print(found_fault)
if quote_count < 3 or named_count < 30:
    found_faults.append('few')
    print(f'only {quote_count} quotes and {named_count} commands')
sys.exit(1 if found_faults else 0)
