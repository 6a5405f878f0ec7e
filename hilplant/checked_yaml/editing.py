"""Values of a YAML text changed in place: comments, order and everything else stay as they were written.

Each change is made at the marks of the syntax tree, and the text is read again: it holds exactly the change, or the
change is refused.
"""

import json
import math
import re
from collections.abc import Iterator
from typing import Any

import yaml

from hilplant.checked_yaml.yaml_reader import Location, read_text, scalar
from hilplant.failure import Failure

_PLAIN = re.compile(r"[A-Za-z_][\w./+-]*( [\w./+()-]+)*")
_INDENT = 2


class EditError(Failure):
    """A value that cannot be changed where it stands."""


def with_value(text: str, location: Location, value: Any) -> str:
    """Return the text with another value at a location; what is not there yet is put behind its neighbours.

    Groups are changed key by key, so that the comments within them stay.

    Raises
    ------
    EditError
        When the text cannot be read, or the value cannot be changed where it stands.

    """
    data = _data(text)
    wanted = _replaced(data, location, value)
    changed = text
    for place, inner in _differences(data, wanted, ()):
        changed = _put(changed, place, inner)
    return _confirmed(changed, wanted, location)


def without(text: str, location: Location) -> str:
    """Return the text without a key, its value and the comment behind it.

    Raises
    ------
    EditError
        When there is no such key, or it cannot be taken out where it stands.

    """
    wanted = _data(text)
    holder = _at(wanted, location[:-1])
    if not isinstance(holder, dict) or location[-1] not in holder:
        raise EditError(f"{_named(location)}: there is no such key")
    del holder[str(location[-1])]
    return _confirmed(_cut(text, location), wanted, location)


def flow(value: Any) -> str:
    """Return a value as YAML on one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{flow(key)}: {flow(inner)}" for key, inner in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(flow, value)) + "]"
    if value is None:
        return "null"
    if isinstance(value, str):
        return value if _PLAIN.fullmatch(value) and scalar(value) == value else _quoted(value)
    if isinstance(value, float) and not math.isfinite(value):
        raise EditError(f"{value} is no value for a file")
    return json.dumps(value) if isinstance(value, bool) else repr(value)


def _quoted(text: str) -> str:
    """Return a text in double quotes, what cannot be printed as escapes."""
    quoted = json.dumps(text, ensure_ascii=False)
    return "".join(letter if letter.isprintable() else f"\\U{ord(letter):08x}" for letter in quoted)


def _data(text: str) -> Any:
    document = read_text(text, "text")
    if document.problems:
        raise EditError(f"line {document.problems[0].line}: {document.problems[0].text}; correct the text first")
    return document.data if document.data is not None else {}


def _confirmed(text: str, wanted: Any, location: Location) -> str:
    if _data(text) != wanted:
        raise EditError(f"{_named(location)}: cannot be changed here without changing more; edit the text")
    return text


def _replaced(data: Any, location: Location, value: Any) -> Any:
    """Return the data with the value at its location; groups on the way there are made where they are missing."""
    if not location:
        return value
    step, rest = location[0], location[1:]
    if isinstance(data, list) and isinstance(step, int) and step <= len(data):
        inner = data[step] if step < len(data) else {}
        return [*data[:step], _replaced(inner, rest, value), *data[step + 1 :]]
    if data is None or isinstance(data, dict):
        group = dict(data or {})
        group[str(step)] = _replaced(group.get(str(step), {}), rest, value)
        return group
    raise EditError(f"{_named(location)}: there is no group of keys to put it in")


def _differences(before: Any, after: Any, place: Location) -> Iterator[tuple[Location, Any]]:
    """Yield the smallest changes that lead from one value to the other."""
    grown = isinstance(before, dict) and isinstance(after, dict) and set(before) <= set(after)
    if grown and (before or not place):
        for key, inner in after.items():
            if key not in before:
                yield (*place, key), inner
            else:
                yield from _differences(before[key], inner, (*place, key))
    elif isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        for index, (old, new) in enumerate(zip(before, after, strict=True)):
            yield from _differences(old, new, (*place, index))
    elif before != after or isinstance(before, bool) is not isinstance(after, bool):
        yield place, after


def _put(text: str, location: Location, value: Any) -> str:
    root = _tree(text)
    if root is None:
        return text + ("\n" if text and not text.endswith("\n") else "") + _block(location, value, 0)
    path = _path(root, location)
    _refuse_alias(root, path, location)
    if len(path) > len(location):
        node = path[-1]
        begin, end = node.start_mark.index, _end(text, node)
        space = " " if begin == end else ""  # nothing is written there, not even a space behind the colon
        return text[:begin] + space + flow(value) + text[end:]
    holder, inside = path[-1], location[len(path) - 1 :]
    if not isinstance(holder, yaml.MappingNode):
        raise EditError(f"{_named(location)}: a list can only be changed as a whole here")
    return _added(text, holder, inside, value)


def _added(text: str, holder: yaml.MappingNode, inside: Location, value: Any) -> str:
    """Put a key that is not there yet behind the last one of its group."""
    for step in reversed(inside[1:]):
        value = {step: value}
    key = str(inside[0])
    if holder.flow_style or not holder.value:
        close = holder.end_mark.index - 1
        comma = ", " if holder.value else ""
        head = text[:close].rstrip() if holder.value else text[:close]
        return f"{head}{comma}{flow(key)}: {flow(value)}{text[close:]}"
    last = _end(text, holder.value[-1][1])
    line_end = text.find("\n", last)
    line_end = len(text) if line_end < 0 else line_end
    written = _block((key,), value, holder.value[0][0].start_mark.column)
    return f"{text[:line_end]}\n{written.rstrip()}{text[line_end:] or chr(10)}"


def _block(location: Location, value: Any, indent: int) -> str:
    """Return a key with its value as lines; groups whose values are groups take a line for each key."""
    pad = " " * indent
    *outer, key = location
    if outer:
        return f"{pad}{flow(outer[0])}:\n" + _block((*outer[1:], key), value, indent + _INDENT)
    if isinstance(value, dict) and value and (indent == 0 or _is_long(value)):
        lines = "".join(_block((name,), inner, indent + _INDENT) for name, inner in value.items())
        return f"{pad}{flow(key)}:\n{lines}"
    return f"{pad}{flow(key)}: {flow(value)}\n"


def _is_long(group: dict[str, Any]) -> bool:
    return any(isinstance(inner, dict) for inner in group.values()) or len(flow(group)) > 100


def _cut(text: str, location: Location) -> str:
    root = _tree(text)
    path = _path(root, location) if root is not None else []
    holder = path[-2]
    index = next(index for index, (key, _) in enumerate(holder.value) if key.value == location[-1])
    key, value = holder.value[index]
    begin, end = key.start_mark.index, _end(text, value)
    if holder.flow_style:
        follower = holder.value[index + 1][0].start_mark.index if index + 1 < len(holder.value) else None
        before = _end(text, holder.value[index - 1][1]) if index else begin
        return text[:begin] + text[follower:] if follower is not None else text[:before] + text[end:]
    line = text.rfind("\n", 0, begin) + 1
    after = text.find("\n", end)
    return text[:line] + (text[after + 1 :] if after >= 0 else "")


def _tree(text: str) -> yaml.Node | None:
    root: yaml.Node | None = yaml.compose(text, Loader=yaml.BaseLoader)
    return root


def _path(root: yaml.Node, location: Location) -> list[Any]:
    """Return the nodes that lead to a location, as far as there are any; the root comes first."""
    path: list[Any] = [root]
    for step in location:
        node, found = path[-1], None
        if isinstance(node, yaml.MappingNode):
            found = next((value for key, value in node.value if key.value == str(step)), None)
        elif isinstance(node, yaml.SequenceNode) and isinstance(step, int) and step < len(node.value):
            found = node.value[step]
        if found is None:
            break
        path.append(found)
    return path


def _refuse_alias(root: yaml.Node, path: list[Any], location: Location) -> None:
    """Refuse a value that stands in the text once and in the data twice, or has an anchor."""
    seen: dict[int, int] = {}
    pending = [root]
    while pending:
        node = pending.pop()
        seen[id(node)] = seen.get(id(node), 0) + 1
        if seen[id(node)] == 1 and isinstance(node, yaml.MappingNode):
            pending += [value for _, value in node.value]
        elif seen[id(node)] == 1 and isinstance(node, yaml.SequenceNode):
            pending += node.value
    if any(seen[id(node)] > 1 for node in path):
        raise EditError(f"{_named(location)}: stands in the text once for several keys (an alias); edit the text")


def _end(text: str, node: yaml.Node) -> int:
    """Return where a value ends: that of a block, which the parser only sees ended at what follows, at its last one."""
    if isinstance(node, yaml.MappingNode | yaml.SequenceNode) and not node.flow_style and node.value:
        last = node.value[-1]
        return _end(text, last[1] if isinstance(last, tuple) else last)
    end = int(node.end_mark.index)
    if isinstance(node, yaml.ScalarNode) and node.style in ("|", ">"):
        return len(text[:end].rstrip())
    return end


def _at(data: Any, location: Location) -> Any:
    for step in location:
        data = data.get(step) if isinstance(data, dict) else None
    return data


def _named(location: Location) -> str:
    return ".".join(map(str, location)) or "the file"
