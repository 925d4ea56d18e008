"""Inputs that nobody would write: bytes of good files changed, values of good data replaced, data made up."""

from __future__ import annotations

import copy
import math
import random
from typing import Any

__all__ = ["changed_bytes", "changed_data", "made_up"]

SNIPPETS = (
    b"\x00", b"\x1b[2J", b"\x0c", b"\r", b"\n", b"\t", b"\xff\xfe", b"\xef\xbb\xbf",
    "\u202e".encode(), "\u2028".encode(),
    b"{", b"}", b"[", b"]", b'"', b"'", b":", b": ", b",", b";", b"#", b"- ", b"&a ", b"*a",
    b"!!python/object:os.system ",
    b"<<: ", b"---\n", b"...\n", b"?", b"|", b">", b"1e999", b"-", b"+", b".", b"NaN", b".inf", b"null", b"true",
    b"0x10",
    b"1_000", b"9" * 400, b"\\ud800", b"=cmd|' /C calc'!A0", b"<x>", b"&lt;", b"<!DOCTYPE a>", b"[" * 60, b"{a: " * 60,
)  # fmt: skip
VALUES: tuple[Any, ...] = (
    None, True, False, 0, 1, -1, 7, 8, 10**30, -(10**400), 1e308, -1e308, 1e-308, 1e6, 1e6 + 1, 1e-9, 0.5, math.nan,
    math.inf, "", "x", "nan", "1", "\x1b[2J", "\u202e", "a\nb", "a" * 101, "../../etc/passwd", "/dev/zero", "=1+1", [],
    {},
    [[]], [0, 0, 0], [1, 2], [1, 2, 3], [1, 2, 3, 4], [None] * 3, ["1", "2", "3"], [1e300] * 3, {"": 1},
    {"a": {"b": {}}},
    [0.0] * 20_000, ["x"] * 20_000, [{}] * 20_000,
)  # fmt: skip
KEYS = (
    "",
    "id",
    "format",
    "holes",
    "<x>",
    "<<",
    "<text>",
    "<list>",
    "__class__",
    "a b",
    "\x1b[2J",
    "\u202e",
    "a" * 500,
)


def changed_bytes(data: bytes, chance: random.Random) -> bytes:
    """One to four changes: bytes flipped, cut out, doubled, moved, or replaced by something that has a meaning."""
    for _ in range(chance.choice((1, 1, 1, 2, 4))):
        if not data:
            return data
        at, to = sorted(chance.randrange(len(data) + 1) for _ in range(2))
        piece = data[at : min(to, at + chance.choice((1, 2, 8, 64, len(data))))]
        match chance.randrange(10):
            case 0:
                data = data[:at] + bytes([data[at - 1] ^ (1 << chance.randrange(8))]) + data[at + 1 :]
            case 1:
                data = data[:at] + data[at + len(piece) :]
            case 2:
                data = data[:at] + piece + data[at:]
            case 3:
                data = data[:at]
            case 4:
                data = data[:at] + bytes(chance.randrange(256) for _ in range(chance.choice((1, 4)))) + data[at:]
            case 5 | 6 | 7 if digits := [n for n, byte in enumerate(data) if chr(byte).isdigit()]:
                at = chance.choice(digits)
                data = data[:at] + chance.choice((b"0", b"3", b"7", b"9", b".", b"-", b"e", b"12")) + data[at + 1 :]
            case _:
                data = data[:at] + chance.choice(SNIPPETS) + data[at + chance.choice((0, 0, 1, 4)) :]
    return data


def changed_data(data: Any, chance: random.Random) -> Any:
    """A copy in which one value is replaced, one key is added, renamed or left out, or one entry is doubled."""
    data = copy.deepcopy(data)
    holder, key = chance.choice(_places(data))
    match chance.randrange(5):
        case 0 if isinstance(holder, dict):
            holder[chance.choice(KEYS)] = holder.pop(key)
        case 1 if isinstance(holder, dict):
            holder[chance.choice(KEYS)] = chance.choice(VALUES)
        case 2:
            del holder[key]
        case 3 if isinstance(holder, list):
            holder.insert(key, copy.deepcopy(holder[key]))
        case _:
            holder[key] = copy.deepcopy(chance.choice(VALUES))
    return data


def _places(data: Any) -> list[tuple[Any, Any]]:
    """Every mapping and list with each of its keys, the deeper ones the more often."""
    found: list[tuple[Any, Any]] = []
    for key, value in data.items() if isinstance(data, dict) else enumerate(data):
        found.append((data, key))
        if isinstance(value, (dict, list)):
            found += _places(value)
    return found


def made_up(schema: dict[str, Any], chance: random.Random, whole: dict[str, Any] | None = None, depth: int = 0) -> Any:
    """Data that a JSON Schema (of pydantic) accepts, numbers at the ends of their ranges among them."""
    whole = schema if whole is None else whole
    if "$ref" in schema:
        return made_up(whole["$defs"][schema["$ref"].rsplit("/", 1)[1]], chance, whole, depth)
    if "const" in schema:
        return schema["const"]
    if "enum" in schema:
        return chance.choice(schema["enum"])
    if options := schema.get("anyOf") or schema.get("oneOf"):
        return made_up(chance.choice(options), chance, whole, depth)
    match schema.get("type"):
        case "object" if "properties" in schema:
            needed = schema.get("required", ())
            return {
                name: made_up(each, chance, whole, depth + 1)
                for name, each in schema["properties"].items()
                if name in needed or chance.random() < 0.5
            }
        case "object":
            return {chance.choice("abc"): made_up(schema["additionalProperties"], chance, whole, depth + 1)}
        case "array":
            least, most = schema.get("minItems", 0), schema.get("maxItems", 4)
            return [
                made_up(schema["items"], chance, whole, depth + 1)
                for _ in range(chance.randint(least, min(most, least + 2)))
            ]
        case "boolean":
            return chance.random() < 0.5
        case "integer":
            low = int(schema.get("minimum", -3))
            return chance.randint(low, min(int(schema.get("maximum", low + 9)), low + 9))
        case "number":
            low = schema.get("minimum", schema.get("exclusiveMinimum", -1000.0))
            high = schema.get("maximum", 1000.0)
            inner = chance.uniform(max(low, -1000.0), min(high, 1000.0))
            return chance.choice((inner, inner, inner, round(inner), low, high, low + 1e-9))
        case "string":
            return chance.choice(("kuka_kr6_r700_2", "thesis_drill", "a", "h 1", "ä", "0"))
        case "null":
            return None
    return chance.choice(("a", 1))
