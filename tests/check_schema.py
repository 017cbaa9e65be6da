# SPDX-License-Identifier: MIT
"""Holds JSON against a schema: check_schema.py SCHEMA [DEFINITION] < LINES

Each line of standard input is a document, or all of it is one that has several lines. The first
that is not as the schema says is printed with what is wrong, and the status is 1.
"""
import json
import sys

import jsonschema


def documents(text):
    """The document, or that of each line."""
    try:
        return [json.loads(text)]
    except ValueError:
        return [json.loads(line) for line in text.splitlines()]


def unique(pairs):
    """An object without a key that comes twice."""
    assert len(dict(pairs)) == len(pairs), f"a key comes twice: {pairs}"
    return dict(pairs)


def main():
    with open(sys.argv[1]) as file:
        schema = json.load(file, object_pairs_hook=unique)
    jsonschema.Draft7Validator.check_schema(schema)
    if len(sys.argv) > 2:
        schema = {"$ref": "#/definitions/" + sys.argv[2], "definitions": schema["definitions"]}
    checker = jsonschema.Draft7Validator(schema)
    found = documents(sys.stdin.read())
    for document in found:
        for error in checker.iter_errors(document):
            print(f"{json.dumps(document)[:400]}\n{error.message[:400]}")
            sys.exit(1)
    print(f"{len(found)} documents")


main()
