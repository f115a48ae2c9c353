"""The reference of JSON outputs: each schema as a page, with a table for each kind of object."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from docs.site_build import markdown
from docs.site_build.site_files import Section, SiteFile

FOLDER = "reference/json/"

Schema = Mapping[str, Any]


def schema_section(folder: Path) -> Section:
    """An overview and a page for each schema of a folder."""
    schemas = {
        path.name.removesuffix(".schema.json"): json.loads(path.read_text(encoding="utf-8"))
        for path in sorted(folder.glob("*.schema.json"))
    }
    pages = tuple(SiteFile(_path(name), schema_page(name, schema), name) for name, schema in schemas.items())
    rows = [(f"[{name}]({name}.md)", markdown.plain(schema["title"])) for name, schema in schemas.items()]
    overview = markdown.joined(
        "# JSON",
        "Each JSON output of tachk has a schema. Fields may be added; a field keeps its name, type and unit.",
        markdown.table(("schema", "of what"), rows),
    )
    homes = {f"docs/schema/{name}.schema.json": _path(name) for name in schemas}
    return Section(
        FOLDER,
        (SiteFile(f"{FOLDER}index.md", overview, "All schemas"), *pages),
        {**homes, "docs/schema": f"{FOLDER}index.md"},
    )


def _path(name: str) -> str:
    return f"{FOLDER}{name}.md"


def schema_page(name: str, schema: Schema) -> str:
    """The objects of a schema: the whole one first, then each definition."""
    whole = _objects("The whole output", {**schema, "description": ""})
    definitions = (part for title, each in schema.get("$defs", {}).items() for part in _objects(title, each))
    return markdown.joined(
        f"# {markdown.plain(schema['title'])}",
        markdown.plain(schema.get("description", "")),
        f"The schema itself: [{name}.schema.json](../../schema/{name}.schema.json){{ download }}.",
        *whole,
        *definitions,
    )


def _objects(title: str, schema: Schema) -> Iterator[str]:
    """A heading with the fields of an object below it; of alternatives, each with its own fields."""
    yield f"## {title} {{ #{_anchor(title)} }}"
    yield from _described(schema)


def _described(schema: Schema) -> Iterator[str]:
    yield markdown.plain(schema.get("description", ""))
    variants = schema.get("oneOf", schema.get("anyOf", ()))
    if variants:
        yield "One of these:"
        for number, variant in enumerate(variants, 1):
            if "properties" in variant:
                yield f"### {number}. {markdown.plain(_kind(variant))}"
                yield from _described(variant)
            else:
                yield f"- {_type(variant)}{_remark(variant)}"
                yield _fields(variant)
    else:
        yield "" if "properties" in schema else f"{_type(schema)[:1].upper()}{_type(schema)[1:]}."
        yield _fields(schema)


def _fields(schema: Schema) -> str:
    """A table of the fields of an object, or of the objects in a list; nothing for other values."""
    rows = [row for inner, marks in _inner_objects(schema, "") for row in _rows(inner, f"{marks}." if marks else "")]
    return markdown.table(("field", "type", "meaning"), rows)


def _kind(variant: Schema) -> str:
    """What tells a variant from the others: its constant fields, or its description."""
    constants = [f"{name} = {each['const']}" for name, each in variant["properties"].items() if "const" in each]
    return ", ".join(constants) or variant.get("title") or "object"


def _rows(schema: Schema, prefix: str) -> Iterator[tuple[str, str, str]]:
    """A row for each field of an object, and for those of objects inside it, by their paths."""
    required = schema.get("required", ())
    for name, field in schema["properties"].items():
        path = f"{prefix}{name}"
        optional = "" if name in required else " *optional*"
        yield markdown.code(path) + optional, _type(field), markdown.plain(field.get("description", ""))
        for inner, marks in _inner_objects(field, ""):
            yield from _rows(inner, f"{path}{marks}.")


def _inner_objects(field: Schema, marks: str) -> Iterator[tuple[Schema, str]]:
    """The objects written within a field, with what leads to them: `[]` for items, `{}` for values of any name."""
    if "properties" in field:
        yield field, marks
    for variant in (*field.get("oneOf", ()), *field.get("anyOf", ())):
        yield from _inner_objects(variant, marks)
    for item in (field.get("items"), *field.get("prefixItems", ())):
        if isinstance(item, dict):
            yield from _inner_objects(item, marks + "[]")
    values = field.get("additionalProperties")
    if isinstance(values, dict):
        yield from _inner_objects(values, marks + "{}")


def _type(schema: Schema) -> str:
    """The values of a schema in words."""
    if "$ref" in schema:
        return _reference(schema["$ref"])
    if "const" in schema:
        return markdown.code(json.dumps(schema["const"]))
    if "enum" in schema:
        return ", ".join(markdown.code(json.dumps(value)) for value in schema["enum"])
    variants = schema.get("oneOf", schema.get("anyOf", ()))
    if variants:
        return " or ".join(dict.fromkeys(_type(variant) for variant in variants))
    names = schema.get("type", "any value")
    names = [names] if isinstance(names, str) else names
    return " or ".join(_named_type(name, schema) for name in names) + _limits(schema)


def _named_type(name: str, schema: Schema) -> str:
    if name == "array":
        items = schema.get("items")
        fixed = [_type(each) for each in schema.get("prefixItems", ())]
        if fixed:
            return f"list of {', '.join(fixed)}"
        return f"list of {_type(items)}" if isinstance(items, dict) and items else "list"
    if name == "object" and isinstance(schema.get("additionalProperties"), dict):
        return f"object with any names, values: {_type(schema['additionalProperties'])}"
    return name


def _reference(target: str) -> str:
    """A link to a definition of this or of another schema."""
    file, _, path = target.partition("#")
    name = path.rpartition("/")[2]
    page = f"{file.removesuffix('.schema.json')}.md" if file else ""
    shown = name or file.removesuffix(".schema.json")
    anchor = f"#{_anchor(name)}" if name else "" if page else "#the-whole-output"
    return f"[{shown or 'the whole output'}]({page}{anchor})"


def _anchor(title: str) -> str:
    return title.lower().replace(" ", "-")


def _limits(schema: Schema) -> str:
    parts = [
        f"{words} {schema[key]}"
        for key, words in (
            ("minimum", "at least"),
            ("exclusiveMinimum", "more than"),
            ("maximum", "at most"),
            ("minItems", "at least this many:"),
            ("maxItems", "at most this many:"),
            ("maxLength", "characters at most:"),
        )
        if key in schema
    ]
    pattern = (f"like {markdown.code(schema['pattern'])}",) if "pattern" in schema else ()
    listed = ", ".join((*parts, *pattern))
    return f", {listed}" if listed else ""


def _remark(schema: Schema) -> str:
    return f": {markdown.plain(schema['description'])}" if schema.get("description") else ""
