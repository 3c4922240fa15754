#!/usr/bin/env python3
"""The pictures that pages show are what their commands draw.
  pictures.py PELT SOURCE_DIR      (in a folder where it may write)

Runs each command below "The pictures above" of bench/picture/README.md and compares what it draws with the file of that
name there; of an animation the first frame. Another compiler or driver rounds otherwise: a mean difference of kMostMean
is let pass, where other hairs make 1 to 10.
"""
import os
import re
import shlex
import struct
import subprocess
import sys
import zlib

kMostMean = 0.4


def pixels(path):
    """Width, height, bytes of a picture of 8 bits per channel."""
    with open(path, 'rb') as file:
        data = file.read()
    at, packed = 8, b''
    while at < len(data):
        size, kind = struct.unpack('>I4s', data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b'IHDR':
            width, height, _, colour = struct.unpack('>IIBB', body[:10])
        packed += body if kind == b'IDAT' else b''
        at += 12 + size
    step = {0: 1, 2: 3, 6: 4}[colour]
    raw, row, above = zlib.decompress(packed), width * step, bytearray(width * step)
    out = bytearray()
    for y in range(height):
        way, line = raw[y * (row + 1)], bytearray(raw[y * (row + 1) + 1:(y + 1) * (row + 1)])
        for i in range(row if way else 0):
            left, corner = (line[i - step], above[i - step]) if i >= step else (0, 0)
            if way == 4:  # Paeth
                guess = left + above[i] - corner
                near = min((abs(guess - left), 0, left), (abs(guess - above[i]), 1, above[i]), (abs(guess - corner), 2, corner))[2]
            else:
                near = (0, left, above[i], (left + above[i]) // 2)[way]
            line[i] = (line[i] + near) & 255
        out += line
        above = line
    return width, height, bytes(out)


def difference(is_path, shown_path):
    """Why the two are not one picture, or nothing."""
    drawn, shown = pixels(is_path), pixels(shown_path)
    if drawn[:2] != shown[:2]:
        return f'{drawn[0]} x {drawn[1]} is drawn, {shown[0]} x {shown[1]} shown'
    mean = sum(abs(a - b) for a, b in zip(drawn[2], shown[2])) / len(shown[2])
    return f'differs by {mean:.2f} of 255 in the mean' if mean > kMostMean else ''


pelt, folder = sys.argv[1], os.path.join(sys.argv[2], 'bench', 'picture')
with open(os.path.join(folder, 'README.md'), encoding='utf-8') as readme:
    commands = re.findall(r'^    pelt (run .*)$', readme.read().partition('## The pictures above')[2], re.MULTILINE)
faults, held = ([] if commands else ['bench/picture/README.md: no commands']), set()
os.makedirs('looks', exist_ok=True)
for command in commands:
    command = command.replace('../', os.path.dirname(folder) + '/')
    file = re.search(r'--(?:picture|animation|steps) (\S+\.png)', command)[1]
    held.add(file)
    done = subprocess.run([pelt, *shlex.split(command), '--no-digest'], capture_output=True, text=True)
    if 'no OpenGL' in done.stderr:
        print(f'SKIPPED: {file}: no OpenGL')
        continue
    fault = done.stderr.strip() if done.returncode else difference(file, os.path.join(folder, file))
    if fault:
        faults.append(f'bench/picture/{file}: {fault}: draw it anew: pelt {command}')
there = {os.path.relpath(os.path.join(where, name), folder) for where, _, names in os.walk(folder) for name in names if name.endswith('.png')}
faults += [f'bench/picture/{file}: no command in README.md draws it' for file in sorted(there - held)]
print('\n'.join(faults))
sys.exit(1 if faults else 0)
