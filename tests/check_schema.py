# SPDX-License-Identifier: MIT
"""Holds JSON against schemas: check_schema.py FILE SCHEMA DEFINITION...

Each line of a FILE is a document, or all of it is one that has several lines. DEFINITION is one of
the schema, or - for the whole schema. Of each file the first document that is not as the schema
says is printed with what is wrong, after the file's name."""
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


def check(name, path, definition):
    with open(path) as file:
        schema = json.load(file, object_pairs_hook=unique)
    jsonschema.Draft7Validator.check_schema(schema)
    if definition != "-":
        schema = {"$ref": "#/definitions/" + definition, "definitions": schema["definitions"]}
    checker = jsonschema.Draft7Validator(schema)
    with open(name) as file:
        try:
            for document in documents(file.read()):
                checker.validate(document)
        except (ValueError, jsonschema.ValidationError) as error:
            print(f"{name}: {str(error)[:800]}")


for i in range(1, len(sys.argv), 3):
    check(*sys.argv[i:i + 3])
