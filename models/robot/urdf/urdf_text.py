"""The text of a URDF: what of it is read, what is refused, and what is passed over by name."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from difflib import get_close_matches

from quietarm.models.number_checks import clipped, quoted, spelling

CHILDREN: Mapping[str, tuple[str, ...]] = {
    "robot": ("link", "joint"),
    "link": ("inertial",),
    "inertial": ("origin", "mass", "inertia"),
    "joint": ("origin", "parent", "child", "axis", "limit", "mimic", "dynamics"),
}
"""The elements that are read, by the element that holds them."""
ATTRIBUTES: Mapping[str, tuple[str, ...]] = {
    "robot": ("name",),
    "link": ("name",),
    "joint": ("name", "type"),
    "origin": ("xyz", "rpy", "quat_xyzw"),
    "mass": ("value",),
    "inertia": ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"),
    "parent": ("link",),
    "child": ("link",),
    "axis": ("xyz",),
    "limit": ("lower", "upper", "effort", "velocity", "acceleration", "deceleration", "jerk"),
    "mimic": ("joint", "multiplier", "offset"),
    "dynamics": ("damping", "friction"),
}
"""The attributes that are read, by element."""
_MANY = ("link", "joint")
"""Elements of which a robot has as many as it likes; it has one of every other."""
_WITHOUT_EFFECT: Mapping[str, tuple[str, ...]] = {
    "robot": ("material", "transmission", "gazebo", "sensor", "version"),
    "link": ("visual", "collision", "contact", "self_filter", "collision_checking"),
    "joint": ("calibration",),
}
"""Elements that do not bear on how a robot moves, such as shapes for pictures."""
_NUMBERS = ("origin", "mass", "inertia", "axis", "limit", "mimic", "dynamics", "inertial")
"""Elements whose attributes bear on how a robot moves."""
READING = "reading"
"""The attribute of <robot> that says in which way the text of a saved robot was filtered."""
_THIS_READING = "2"
_MOST_LINKS = 1000
"""Humanoids with their hands have some two hundred."""
_NEAR = 0.8
"""Share of letters in common from which on a name is another one that was mistyped; real URDFs
have `command_effort` and `gear_velocity`, which are none."""
_COMMENT = re.compile("<!--.*?-->", re.DOTALL)
_XACRO = re.compile(r"<xacro:|\$\{")


def parse(text: str) -> ElementTree.Element:
    """Return the element <robot> of a URDF.

    Raises
    ------
    ValueError
        When it is no URDF, has XML entities or macros, an element twice of which there is one, or
        an element or attribute that is another one mistyped.
    """
    root = _parse_xml(text)
    if root.tag != "robot":
        raise ValueError(f"the URDF begins with <{clipped(root.tag)}>; give one of <robot>")
    if root.find("robot") is not None:
        raise ValueError("the URDF holds several robots; give a file for each, or one tree of all")
    links = len(root.findall("link"))
    if links > _MOST_LINKS:
        raise ValueError(f"the URDF has {links} links; give at most {_MOST_LINKS}")
    if _XACRO.search(_COMMENT.sub("", text)):
        raise ValueError("the URDF has xacro's macros; run xacro on it first, and give its output")
    for element, owner in _read(root):
        _refuse_mistyped(element, owner)
        _refuse_twice(element, owner)
    for kind in _MANY:
        names = Counter(element.get("name") for element in root.findall(kind))
        for name, count in names.items():
            if name and count > 1:
                number = "two" if count == 2 else str(count)
                raise ValueError(
                    f"{number} {kind}s are called {quoted(name)} in the URDF; give each its own "
                    "name"
                )
    return root


def dynamics_of(text: str) -> str:
    """The URDF without what the dynamics do not need: pictures, collisions, transmissions.

    ValueError where it is no URDF.
    """
    return _filtered(parse(text))


def passed_over(text: str) -> list[str]:
    """Name the entries of a URDF that may bear on the motion and are not read, and whose they are.

    Each entry once, with the first link or joint that has it and how many more do.
    """
    owners = dict[str, list[str]]()
    for element, owner in _read(parse(text)):
        for entry in _unread(element):
            owners.setdefault(entry, []).append(quoted(owner.get("name")))
    return [
        f"{entry} of {names[0]}{f' and {len(names) - 1} more' if len(names) > 1 else ''}"
        for entry, names in owners.items()
    ]


def _unread(element: ElementTree.Element) -> Iterator[str]:
    """List what is not read of an element: attributes with numbers, inner elements."""
    if element.tag in _NUMBERS:
        known = ATTRIBUTES.get(element.tag, ())
        yield from (f"{name} of {element.tag}" for name in element.attrib if name not in known)
    if element.tag in CHILDREN and element.tag != "robot":
        known = (*CHILDREN[element.tag], *_WITHOUT_EFFECT.get(element.tag, ()))
        for child in element:
            if child.tag not in known:
                yield f"{child.tag}{_soft_range(child)}"


def _soft_range(element: ElementTree.Element) -> str:
    """The range in which a safety controller lets its joint move at all, in words."""
    ends = [element.get(f"soft_{end}_limit") for end in ("lower", "upper")]
    return f" ({ends[0] or 'none'} to {ends[1] or 'none'})" if any(ends) else ""


def as_read_before(text: str) -> str:
    """The text of a robot that version 2.0.0 saved, such that it means what it meant there.

    It read the last of two links or joints of a name and the first of two other elements, took no
    effort or velocity below 0, no joint as following another, and a missing end of a range as none.
    What cannot be parsed is returned as it is.
    """
    try:
        root = _parse_xml(text)
    except ValueError:
        return text
    if root.tag != "robot" or root.get(READING) is not None:
        return text
    for kind in _MANY:
        last = {element.get("name"): element for element in root.findall(kind)}
        for element in root.findall(kind):
            if last[element.get("name")] is not element:
                root.remove(element)
    for element, _ in list(_read(root)):
        seen = set[str]()
        for child in list(element):
            known = child.tag in CHILDREN.get(element.tag, ()) and child.tag != "mimic"
            again = child.tag in seen and child.tag not in _MANY
            if not known or again or child.tag == "dynamics":
                element.remove(child)
            seen.add(child.tag)
    for limit in root.iterfind("joint/limit"):
        _as_limit_before(limit)
    return _filtered(root)


def _as_limit_before(limit: ElementTree.Element) -> None:
    for name in ("acceleration", "deceleration", "jerk"):
        limit.attrib.pop(name, None)
    for name in ("effort", "velocity"):
        if _is_below(limit.get(name), "0"):
            del limit.attrib[name]
    ends = (limit.get("upper"), limit.get("lower"))
    if None in ends or _is_below(*ends):
        limit.attrib.pop("lower", None)
        limit.attrib.pop("upper", None)


def _is_below(text: str | None, other: str | None) -> bool:
    try:
        return float(text or "nan") < float(other or "nan")
    except ValueError:
        return False


def _parse_xml(text: str) -> ElementTree.Element:
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise ValueError(
            "the URDF has a document type or XML entities, which are not read; write out what they "
            "stand for"
        )
    try:
        return ElementTree.fromstring(text.removeprefix("\ufeff").encode())
    except ElementTree.ParseError as error:
        if "junk after document element" in str(error):
            raise ValueError(
                "the URDF goes on after </robot>, as with several robots; give a file for each"
            ) from None
        raise ValueError(
            f"the URDF is no valid XML ({clipped(str(error))}); export it again"
        ) from None


def _filtered(root: ElementTree.Element) -> str:
    """The text of what is read alone, with how it was read."""
    for element, _ in list(_read(root)):
        for child in list(element):
            if child.tag not in CHILDREN.get(element.tag, ()):
                element.remove(child)
        for name in list(element.attrib):
            if name not in ATTRIBUTES.get(element.tag, ()):
                del element.attrib[name]
        element.text = None
        element.tail = None
    root.set(READING, _THIS_READING)
    return ElementTree.tostring(root, encoding="unicode")


def _read(
    element: ElementTree.Element, owner: ElementTree.Element | None = None
) -> Iterator[tuple[ElementTree.Element, ElementTree.Element]]:
    """Every element that is read, with the link or joint that it belongs to."""
    owner = element if owner is None or element.tag in _MANY else owner
    yield element, owner
    for child in element:
        if child.tag in CHILDREN.get(element.tag, ()):
            yield from _read(child, owner)


def _refuse_mistyped(element: ElementTree.Element, owner: ElementTree.Element) -> None:
    known = CHILDREN.get(element.tag, ())
    others = _WITHOUT_EFFECT.get(element.tag, ())
    for child in element:
        near = _mistyped(str(child.tag), known, others)
        if near:
            raise ValueError(f"{_words(owner)} has no entry <{child.tag}>; did you mean <{near}>?")
    for name in element.attrib:
        near = _mistyped(name, ATTRIBUTES.get(element.tag, ()), others)
        if near:
            raise ValueError(
                f"<{element.tag}> of {_words(owner)} has no {quoted(name)}; did you mean {near!r}?"
            )


def _mistyped(name: str, known: Collection[str], others: Collection[str]) -> str:
    """The known name that an unknown one was meant to be; an empty one where none is near."""
    if name in known or name in others or name == READING:
        return ""
    same = [other for other in known if spelling(other) == spelling(name).removeprefix("max")]
    near = same or get_close_matches(name.lower(), list(known), n=1, cutoff=_NEAR)
    return near[0] if near else ""


def _refuse_twice(element: ElementTree.Element, owner: ElementTree.Element) -> None:
    for tag, count in Counter(child.tag for child in element).items():
        if count > 1 and tag in CHILDREN.get(element.tag, ()) and tag not in _MANY:
            number = "two" if count == 2 else str(count)
            raise ValueError(f"{_words(owner)} has {number} <{tag}>; give one")


def _words(owner: ElementTree.Element) -> str:
    """Return the name of a robot, link or joint for an error."""
    if owner.tag == "robot":
        return "the URDF"
    return f"{owner.tag} {quoted(owner.get('name'))} of the URDF"
