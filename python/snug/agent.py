"""Agents written in Python: what they are given, what they return, and the program that `snug pack --agent` asks.

An agent is any object with

    def decide(self, state, item, candidates): ...

It returns what the item shall be tried as, best first: candidates (as given), their indices, or `Place` objects; one
of these or a list; None or an empty list when there is no place. It may have `begin(self, settings, container,
future)`, called once before the first item. A class for `snug pack --agent module:Class` is made without arguments.

This file needs nothing but Python's standard library: the program runs it with any interpreter, without the module.
Run as a program (`python3 agent.py module:Class`) it answers lines of JSON on standard output (docs/python.md); what
the agent prints goes to standard error.
"""
from __future__ import annotations

import importlib
import json
import os
import sys
import traceback
from typing import Any, Callable, Dict, List, Sequence


class Values:
    """The numbers and words of a JSON object as attributes. Lengths in m, masses in kg, frame T."""

    def __init__(self, values: Dict[str, Any]):
        self.__dict__.update(values)

    def __repr__(self) -> str:
        return "Values(" + ", ".join(f"{key}={value!r}" for key, value in self.__dict__.items()) + ")"


class Item(Values):
    """A box to be placed: id, type, size [x, y, z] along its own axes, mass, com, arrival (up, up_sign, yaw_quarter),
    upright_only, no_stack, max_load (kg or None)."""


class Box(Item):
    """A box that stands in the container: an Item with position and quaternion_wxyz in T, and low and high, the
    corners of its extent along Tx, Ty, Tz."""


class Candidate(Values):
    """A corner where the item can be lowered: index, up, up_sign, yaw_quarter, flips, low [x, y, z], extents, support
    (part of its lower face that rests on something)."""


class State:
    """What stands in the container: `boxes` in the order of packing, `inner_size` [x, y, z], `walls`; `obstacles`: what
    else is there, as dicts of `low` and `high` [x, y, z]. Candidates keep to them."""

    def __init__(self, container: Dict[str, Any], boxes: List[Box], obstacles: Sequence[Dict[str, List[float]]] = ()):
        self.inner_size: List[float] = container.get("inner_size", [])
        self.walls: bool = container.get("walls", True)
        self.boxes = boxes
        self.obstacles = list(obstacles)


class Place:
    """A place of the agent's own: the item is lowered with its middle at (x, y) [m, in T] until it rests; which of its
    axes is up ("X", "Y", "Z"), which end (1, -1), quarter turns about the vertical (0 .. 3)."""

    def __init__(self, x: float, y: float, up: str = "Z", up_sign: int = 1, yaw_quarter: int = 0):
        self.x, self.y, self.up, self.up_sign, self.yaw_quarter = x, y, up, up_sign, yaw_quarter


def _as_answer(place: Any) -> Any:
    if isinstance(place, Candidate):
        return place.__dict__["index"]
    if isinstance(place, Place):
        return {"x": float(place.x), "y": float(place.y), "up": place.up, "up_sign": int(place.up_sign),
                "yaw_quarter": int(place.yaw_quarter)}
    if isinstance(place, bool) or not hasattr(place, "__index__"):
        raise TypeError(f"decide() returned {place!r}: expected candidates, their indices or Place objects")
    return int(place)


def answerer(agent: Any) -> Callable[[str], str]:
    """What turns a line of JSON that asks into one that answers."""
    if not callable(getattr(agent, "decide", None)):
        raise TypeError(f"{agent!r} is no agent: it has no decide(state, item, candidates)")
    container: Dict[str, Any] = {}

    def answer(line: str) -> str:
        question = json.loads(line)
        if question["ask"] == "begin":
            container.update(question["container"])
            if hasattr(agent, "begin"):
                agent.begin(question["settings"], question["container"], question["future"])
            return "{}"
        state = State(container, [Box(box) for box in question["boxes"]], question.get("obstacles", []))
        chosen = agent.decide(state, Item(question["item"]), [Candidate(one) for one in question["candidates"]])
        if chosen is None:
            return '{"places": []}'
        if not isinstance(chosen, (list, tuple)):
            chosen = [chosen]
        return json.dumps({"places": [_as_answer(place) for place in chosen]})

    return answer


class _NotFound(Exception):
    """There is no such module or class: nothing of the agent has run that a traceback could tell of."""


def _find(words: str) -> Any:
    module, _, name = words.partition(":")
    if not module:
        raise _NotFound("no module before the colon")
    try:
        found: Any = importlib.import_module(module)
    except ModuleNotFoundError as error:
        if error.name is None or not f"{module}.".startswith(f"{error.name}."):
            raise  # of what the module imports
        raise _NotFound(str(error)) from error
    for part in name.split("."):
        if not hasattr(found, part):
            raise _NotFound(f"{getattr(found, '__name__', module)} has no {part!r}")
        found = getattr(found, part)
    return found() if isinstance(found, type) else found


def _serve(words: str) -> int:
    """Answers until standard input ends."""
    out = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # print() of the agent
    sys.path[0] = os.getcwd()  # where the modules of the one who calls are; not this file's neighbours

    def say(line: str) -> None:
        out.write(line + "\n")
        out.flush()

    try:
        answer = answerer(_find(words))
    except _NotFound as error:
        say(json.dumps({"error": str(error)}))
        return 1
    except BaseException as error:  # pylint: disable=broad-except
        traceback.print_exc()
        say(json.dumps({"error": f"{type(error).__name__}: {error}"}))
        return 1
    say(json.dumps({"ready": words}))
    for line in sys.stdin:
        try:
            say(answer(line))
        except BaseException as error:  # pylint: disable=broad-except
            traceback.print_exc()
            say(json.dumps({"error": f"{type(error).__name__}: {error}"}))
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        print("usage: agent.py module:Class", file=sys.stderr)
        sys.exit(2)
    sys.exit(_serve(sys.argv[1]))
