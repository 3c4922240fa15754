#!/usr/bin/env python3
"""Checks JSON against bench/report/json_keys.txt, whose head describes its lines.

    json_keys.py KEYS.txt SECTION FILE.json      exit code 1 and every fault by its path
    json_keys.py KEYS.txt                        the sections
    json_keys.py --self-test
"""
import json
import re
import sys

LINE = re.compile(r'(?P<indent> *)(?P<key>[$\w:/ -]+?)(?P<optional>\??):(?: (?P<type>[^ ].*?))?(?:  -- (?P<text>.*))?$')
HEX = {'digest': 16, 'bits': 8}


def parse(lines):
    """{section: node}; a node is (type, {key: (is optional, node)})."""
    root, stack = {}, []
    for number, line in enumerate(lines, 1):
        if not line.strip() or line.startswith('#'):
            continue
        found = LINE.match(line.rstrip('\n'))
        if not found:
            sys.exit(f'line {number}: not KEY: TYPE  -- TEXT')
        depth = len(found['indent']) // 2
        node = ((found['type'] or 'object').strip(), {})
        del stack[depth:]
        keys = stack[-1][1] if stack else root
        if found['key'] in keys:
            sys.exit(f"line {number}: '{found['key']}' stands there twice")
        keys[found['key']] = (bool(found['optional']), node) if stack else node
        stack.append(node)
    return root


def is_of(value, name):
    if name in HEX:
        return isinstance(value, str) and re.fullmatch('[0-9a-f]{%d}' % HEX[name], value)
    if name.startswith('"'):
        return value == name[1:-1]
    if isinstance(value, bool):
        return name in ('boolean', 'any')
    return {'text': isinstance(value, str), 'number': isinstance(value, (int, float)),
            'integer': isinstance(value, int), 'null': value is None, 'any': True}.get(name, False)


def faults(value, node, root, path='$'):
    kind, keys = node
    if kind.startswith('$'):
        yield from faults(value, root[kind], root, path)
    elif kind.startswith('list of'):
        if not isinstance(value, list):
            yield f'{path}: is no list'
            return
        for i, one in enumerate(value):
            yield from faults(one, (kind[8:] or 'object', keys), root, f'{path}[{i}]')
    elif kind.startswith('map of'):
        if not isinstance(value, dict):
            yield f'{path}: is no object'
            return
        for name, one in value.items():
            yield from faults(one, (kind[7:] or 'object', keys), root, f'{path}.{name}')
    elif kind != 'object':
        if not any(is_of(value, name) for name in kind.split(' | ')):
            yield f'{path}: is {json.dumps(value)[:60]}, not {kind}'
    elif not isinstance(value, dict):
        yield f'{path}: is no object'
    else:
        yield from (f"{path}: has no '{name}'" for name, (optional, _) in keys.items() if not optional and name not in value)
        for name, member in value.items():
            if name in keys:
                yield from faults(member, keys[name][1], root, f'{path}.{name}')
            else:
                yield f"{path}: '{name}' is not documented"


def self_test():
    root = parse('''# a comment
s:  -- pelt s
  a: list of $n
  b?: "x y" | null
  c?: map of
    d: digest  -- 64 bits
  e?: list of list of integer
  f?: number | null
$n:
  k: boolean
'''.split('\n'))
    good = [{'a': []}, {'a': [{'k': True}], 'b': 'x y', 'c': {'any': {'d': '0' * 16}}, 'e': [[1]], 'f': None}, {'a': [], 'f': 1.5}]
    bad = [{}, [], {'a': {}}, {'a': [1]}, {'a': [{'k': 1}]}, {'a': [{}]}, {'a': [], 'b': 'x'}, {'a': [], 'c': {'any': {}}},
           {'a': [], 'c': {'any': {'d': '0'}}}, {'a': [], 'e': [[1.5]]}, {'a': [], 'e': [[True]]}, {'a': [], 'f': 'x'}, {'a': [], 'g': 1}]
    for value in good:
        assert not list(faults(value, root['s'], root)), value
    for value in bad:
        assert list(faults(value, root['s'], root)), value
    print('json_keys: the checker sees', len(bad), 'faults')


def main():
    if sys.argv[1:] == ['--self-test']:
        return self_test()
    with open(sys.argv[1], encoding='utf-8') as file:
        root = parse(file)
    if len(sys.argv) == 2:
        return print('\n'.join(name for name in root if not name.startswith('$')))
    with open(sys.argv[3], encoding='utf-8') as file:
        found = list(faults(json.load(file), root[sys.argv[2]], root))
    print('\n'.join(found[:20]))
    sys.exit(1 if found else 0)


if __name__ == '__main__':
    main()
