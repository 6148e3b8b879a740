"""Examples for the answers of the OpenAPI document, made from their schemas.

A property's own examples go first, then its default, then what a name like its own usually holds.
"""

from collections.abc import Mapping
from typing import Any, Final

Schema = Mapping[str, Any]

_ID: Final = "0f8fad5bd9cb469fa16570867728950e"
_DIGEST: Final = "9b2b3a5c" * 8
_NAMES: Final[dict[str, Any]] = {
    "id": _ID,
    "run": _ID,
    "recording": _DIGEST,
    "recording_digest": _DIGEST,
    "digest": _DIGEST,
    "camera_serial": "B0001",
    "band": "NIR",
    "radiance_unit": "W m-2 sr-1",
    "region": "0:6144",
    "bit_depth": 12,
    "columns": 6144,
    "block": "003",
    "exposure_us": 400.0,
    "identity": "Agilent N5745A US12A3456B",
    "last_exchange": "> MEAS:CURR?  < (nothing)",
    "message": "lamp 2 does not answer; look at its cable",
    "code": "no-answer",
    "reason": "the lamps were renewed",
    "progress": 0.4,
}
_STRINGS: Final = {"date-time": "2026-11-27T20:22:08Z", "date": "2026-11-27"}


def example_of(schema: Schema, schemas: Mapping[str, Schema], name: str = "") -> Any:
    """Return a value that `schema` allows.

    Args:
        schema: Of JSON Schema, as pydantic writes it.
        schemas: What its references name.
        name: Of the property that it is of.
    """
    if "$ref" in schema:
        return example_of(schemas[schema["$ref"].rpartition("/")[2]], schemas, name)
    if schema.get("examples"):
        return schema["examples"][0]
    for given in ("example", "const", "default"):
        if given in schema:
            return schema[given]
    for options in ("anyOf", "oneOf", "allOf"):
        if options in schema:
            return example_of(schema[options][0], schemas, name)
    if "enum" in schema:
        return schema["enum"][0]
    return _by_type(schema, schemas, name)


def _by_type(schema: Schema, schemas: Mapping[str, Schema], name: str) -> Any:
    match schema.get("type"):
        case "object":
            properties = schema.get("properties", {})
            return {key: example_of(each, schemas, key) for key, each in properties.items()}
        case "array":
            return [example_of(schema["items"], schemas, name)] if "items" in schema else []
        case "boolean":
            return True
        case "string" | "integer" | "number":
            return _scalar(schema, name)
    return {} if name == "" else None


def _scalar(schema: Schema, name: str) -> str | float:
    match schema["type"]:
        case "integer":
            count: Any = _NAMES.get(name, schema.get("minimum", 1))
            return int(count)
        case "number":
            number: Any = _NAMES.get(name, schema.get("minimum", 1.5))
            return float(number)
    if schema.get("minLength", 0) >= len(_DIGEST):
        return _DIGEST
    return _STRINGS.get(schema.get("format", "")) or str(_NAMES.get(name, "lab"))


def add_examples(document: dict[str, Any]) -> None:
    """Give every JSON answer of `document` an example that has none."""
    schemas = document["components"]["schemas"]
    for operations in document["paths"].values():
        for operation in operations.values():
            for response in operation["responses"].values():
                content = response.get("content", {}).get("application/json")
                if content and not {"example", "examples"} & set(content):
                    content["example"] = example_of(content.get("schema", {}), schemas)
