"""Joints that follow others, as a URDF's <mimic> says: which, how, and what that asks of these."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass

from quietarm.models.joint_motion import JointMotion
from quietarm.models.number_checks import nearest_name, quoted
from quietarm.models.robot.urdf.read_urdf import Urdf


@dataclass(frozen=True)
class Following:
    """A joint's position: multiplier times that of the joint that leads, plus offset [rad or m]."""

    leader: str
    multiplier: float = 1.0
    offset: float = 0.0

    def position(self, leading: float) -> float:
        """The joint's position where the leader has one."""
        return self.multiplier * leading + self.offset

    def motion(self, leading: JointMotion) -> JointMotion:
        """The joint's motion by that of the leader."""
        jerk = None if leading.jerk is None else self.multiplier * leading.jerk
        return JointMotion(
            self.multiplier * leading.angle + self.offset,
            self.multiplier * leading.speed,
            self.multiplier * leading.acceleration,
            jerk,
        )

    def range_of_leader(self, lower: float, upper: float) -> tuple[float, float]:
        """Return the range of the leader in which the joint is within its own range."""
        if self.multiplier == 0:
            return (-math.inf, math.inf)
        ends = [(end - self.offset) / self.multiplier for end in (lower, upper)]
        return min(ends), max(ends)


def led_by(urdf: Urdf, joint: str, held: Collection[str] = ()) -> Following:
    """Return the joint that leads one in the end; the joint itself if it follows none.

    One that is `held` follows none. Where the last in a chain mimics a joint that the URDF does not
    have, the leader is that one.
    """
    leader = joint
    multiplier = 1.0
    offset = 0.0
    while leader in urdf.joints and leader not in held:
        mimic = urdf.joints[leader].mimics
        if mimic is None:
            break
        offset += multiplier * mimic.offset
        multiplier *= mimic.multiplier
        leader = mimic.joint
    return Following(leader, multiplier, offset)


def followers_of(urdf: Urdf, held: Collection[str] = ()) -> dict[str, Following]:
    """The moving joints that follow another, by name, those on `held` ones left out."""
    following = {name: led_by(urdf, name, held) for name in urdf.moving}
    return {
        name: entry
        for name, entry in following.items()
        if entry.leader != name and entry.leader not in held and entry.leader in urdf.moving
    }


def driven_joints(
    urdf: Urdf, named: Collection[str] = (), passive: Collection[str] = ()
) -> tuple[str, ...]:
    """The joints that are driven: those that are named, or all that move but passive ones.

    Those that mimic others follow them.
    """
    leading = (name for name in urdf.moving if urdf.joints[name].mimics is None)
    return tuple(named) or tuple(name for name in leading if name not in passive)


def ranges_of_leaders(
    ranges: Mapping[str, tuple[float, float]],
    of_followers: Mapping[str, tuple[float, float]],
    followers: Mapping[str, Following],
) -> dict[str, tuple[float, float]]:
    """Ranges of joints that lead, narrowed such that those that follow keep theirs."""
    narrowed = dict(ranges)
    for name, how in followers.items():
        if name in of_followers and how.leader in narrowed:
            lower, upper = narrowed[how.leader]
            least, most = how.range_of_leader(*of_followers[name])
            narrowed[how.leader] = (max(lower, least), min(upper, most))
    return narrowed


def held_position(urdf: Urdf, joint: str, held: Mapping[str, float]) -> float:
    """Return the position of a joint that no motor moves: as given, 0, or as its leader's."""
    following = led_by(urdf, joint, held)
    return following.position(held.get(following.leader, 0.0))


def limits_with_followers(urdf: Urdf, entry: str, held: Collection[str] = ()) -> dict[str, float]:
    """The limits of an entry of <limit> by joint, those of followers as limits of their leaders."""
    sizes = {name: getattr(joint, entry) for name, joint in urdf.joints.items()}
    return bounds_of_leaders(sizes, followers_of(urdf, held))


def bounds_of_leaders(
    limits: Mapping[str, float], followers: Mapping[str, Following]
) -> dict[str, float]:
    """Limits by joint, those of joints that follow others as limits of these; 0 is none."""
    bounds = dict[str, float]()
    for name, size in limits.items():
        following = followers.get(name, Following(name))
        if size > 0 and following.multiplier:
            bound = size / abs(following.multiplier)
            bounds[following.leader] = min(bound, bounds.get(following.leader, math.inf))
    return bounds


def mimics_nothing(urdf: Urdf, joint: str) -> str:
    """Say which missing joint a joint mimics and which may be meant; empty if none."""
    mimic = urdf.joints[joint].mimics if joint in urdf.joints else None
    if mimic is None or mimic.joint in urdf.joints:
        return ""
    meant = nearest_name(mimic.joint, urdf.joints)
    return f"mimics {quoted(mimic.joint)}{f' (did you mean {quoted(meant)}?)' if meant else ''}"
