#!/usr/bin/env python3
"""Holds JSON to a schema: the part of JSON Schema that bench/report/schemas uses, with the standard library alone.

    json_schema.py SCHEMA.json [FILE.json]      without FILE: standard input; exit code 1 and every fault by its path
    json_schema.py --self-test

A keyword that this file does not know is a fault of the schema, so that nothing is believed to be checked that is not.
"""
import json
import re
import sys

TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "null": type(None), "number": (int, float),
         "integer": int}
KNOWN = {"$schema", "$defs", "$ref", "title", "description", "type", "properties", "required", "additionalProperties",
         "items", "enum", "pattern", "minimum", "anyOf"}


def has_type(value, name):
    if isinstance(value, bool):
        return name == "boolean"
    return isinstance(value, TYPES[name])


def faults(value, schema, root, path="$"):
    """Every way in which the value is not as the schema says."""
    unknown = set(schema) - KNOWN
    if unknown:
        yield f"{path}: the schema has keywords that are not checked: {', '.join(sorted(unknown))}"
        return
    if "$ref" in schema:
        target = root
        for part in schema["$ref"].removeprefix("#/").split("/"):
            target = target[part]
        yield from faults(value, target, root, path)
    if "anyOf" in schema and all(list(faults(value, one, root, path)) for one in schema["anyOf"]):
        yield f"{path}: is as none of the {len(schema['anyOf'])} that it may be"
    if "type" in schema:
        types = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
        if not any(has_type(value, name) for name in types):
            yield f"{path}: is {json.dumps(value)[:60]}, not {' or '.join(types)}"
            return
    if "enum" in schema and value not in schema["enum"]:
        yield f"{path}: {json.dumps(value)[:60]} is none of {schema['enum']}"
    if "pattern" in schema and isinstance(value, str) and not re.search(schema["pattern"], value):
        yield f"{path}: '{value}' does not match {schema['pattern']}"
    if "minimum" in schema and has_type(value, "number") and value < schema["minimum"]:
        yield f"{path}: {value} is below {schema['minimum']}"
    if isinstance(value, dict):
        yield from object_faults(value, schema, root, path)
    if isinstance(value, list) and "items" in schema:
        for i, item in enumerate(value):
            yield from faults(item, schema["items"], root, f"{path}[{i}]")


def object_faults(value, schema, root, path):
    properties, more = schema.get("properties", {}), schema.get("additionalProperties", True)
    for name in schema.get("required", []):
        if name not in value:
            yield f"{path}: has no '{name}'"
    for name, member in value.items():
        if name in properties:
            yield from faults(member, properties[name], root, f"{path}.{name}")
        elif more is False:
            yield f"{path}: '{name}' is not documented"
        elif isinstance(more, dict):
            yield from faults(member, more, root, f"{path}.{name}")


def self_test():
    schema = {"type": "object", "required": ["a"], "additionalProperties": False,
              "properties": {"a": {"type": "array", "items": {"$ref": "#/$defs/n"}}, "b": {"pattern": "^x"},
                             "c": {"enum": [1, "two"]}, "d": {"anyOf": [{"type": "null"}, {"type": "boolean"}]}},
              "$defs": {"n": {"type": "integer", "minimum": 0}}}
    good = [{"a": []}, {"a": [0, 3], "b": "xy", "c": "two", "d": None}]
    bad = [{}, [], {"a": [1.5]}, {"a": [True]}, {"a": [-1]}, {"a": [], "b": "y"}, {"a": [], "c": 2}, {"a": [], "d": 1},
           {"a": [], "e": 1}]
    for value in good:
        assert not list(faults(value, schema, schema)), value
    for value in bad:
        assert list(faults(value, schema, schema)), value
    assert list(faults(1, {"maximum": 3}, {})), "an unknown keyword"
    print("json_schema: the checker sees", len(bad) + 1, "faults")


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    with open(sys.argv[1], encoding="utf-8") as file:
        schema = json.load(file)
    try:
        if len(sys.argv) == 3:
            with open(sys.argv[2], encoding="utf-8") as file:
                value = json.load(file)
        else:
            value = json.load(sys.stdin)
    except ValueError as error:
        sys.exit(f"no JSON: {error}")
    found = list(faults(value, schema, schema))
    for fault in found[:20]:
        print(fault)
    sys.exit(1 if found else 0)


main()
