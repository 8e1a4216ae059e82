#!/usr/bin/env python3
"""Makes kubernetes-schemas.json from the swagger.json of a Kubernetes release: strict schemas of the kinds in
deploy/kubernetes.

  extract_schemas.py swagger.json 1.20.2 > kubernetes-schemas.json

The shipped file is from 1.20.2, the source in Debian 12 (package kubernetes, api/openapi-spec/swagger.json). It is old on
purpose: its stable APIs exist in every later release, while newer ones do not exist everywhere."""
import json
import sys

KINDS = ("ConfigMap", "Deployment", "Namespace", "NetworkPolicy", "Service", "StatefulSet")
VERSIONS = ("v1", "apps/v1", "networking.k8s.io/v1")


def strict(schema):
    """The schema without descriptions, in which unknown keys are errors."""
    if schema.get("format") == "int-or-string":
        return {"type": ["integer", "string"]}
    kept = {key: schema[key] for key in ("type", "required", "enum", "$ref") if key in schema}
    if "properties" in schema:
        kept["properties"] = {name: strict(of) for name, of in sorted(schema["properties"].items())}
        kept["additionalProperties"] = False
    elif "additionalProperties" in schema:
        kept["additionalProperties"] = strict(schema["additionalProperties"])
    if "items" in schema:
        kept["items"] = strict(schema["items"])
    return kept


def referred(schema):
    for key, value in schema.items():
        if key == "$ref":
            yield value.rsplit("/", 1)[1]
        elif isinstance(value, dict):
            yield from referred(value)


def main(swagger, release):
    with open(swagger, encoding="utf-8") as file:
        source = json.load(file)["definitions"]
    kinds = {}
    for name, schema in source.items():
        for of in schema.get("x-kubernetes-group-version-kind", ()):
            version = "/".join(filter(None, (of["group"], of["version"])))
            if of["kind"] in KINDS and version in VERSIONS:
                kinds[f"{version} {of['kind']}"] = name
    definitions, wanted = {}, list(kinds.values())
    while wanted:
        name = wanted.pop()
        if name not in definitions:
            definitions[name] = strict(source[name])
            wanted += referred(definitions[name])
    # The schema declares a string, but numbers are accepted too; only the description gives the format.
    definitions["io.k8s.apimachinery.pkg.api.resource.Quantity"] = {
        "type": ["number", "string"], "pattern": "^[+-]?[0-9]+([.][0-9]*)?([eE][+-]?[0-9]+|[numkMGTPE]|[KMGTPE]i)?$"}
    print("{" + json.dumps("from") + ": " + json.dumps(
        f"Kubernetes {release}, Copyright The Kubernetes Authors, Apache-2.0; made by extract_schemas.py"))
    print(', "kinds": ' + json.dumps(dict(sorted(kinds.items()))))
    print(', "definitions": {')
    print(",\n".join(f"{json.dumps(name)}: {json.dumps(definitions[name], separators=(',', ':'))}" for name in sorted(definitions)))
    print("}}")


if __name__ == "__main__":
    main(*sys.argv[1:])
