"""Runs from one call, their results and recordings, and the report page around them."""
from __future__ import annotations

import html
import os
from pathlib import Path
from typing import Any, Callable, Dict, Iterable, Iterator, List, Optional, Tuple, Union

from . import _core
from ._errors import refused
from .agent import answerer

PathLike = Union[str, "os.PathLike[str]"]


def _flat(value: Any, name: str = "") -> Iterator[Tuple[str, Any]]:
    """Pairs of a name and a number or word."""
    parts: Optional[Iterable[Tuple[Any, Any]]] = None
    if isinstance(value, dict):
        parts = value.items()
    elif isinstance(value, list):
        parts = enumerate(value)
    if parts is None:
        yield name, value
        return
    for key, part in parts:
        yield from _flat(part, f"{name}.{key}" if name else str(key))


class Result(Dict[str, Any]):
    """What became of a run: the JSON of `snug pack --json` and `snug simulate --json`, its keys also as attributes.

    docs/formats.md tells the keys and their units.
    """

    program: Optional[_core.Program] = None  # of a packing session

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"a result without '{name}'; it has {', '.join(self)}") from None

    def __repr__(self) -> str:
        def short(value: Any) -> str:
            many = isinstance(value, (list, dict)) and len(value) > 0
            return f"{len(value)} of them" if many else f"{value:.6g}" if isinstance(value, float) else repr(value)

        return f"snug.Result({', '.join(f'{key}: {short(value)}' for key, value in self.items())})"

    def records(self, key: str = "items") -> List[Dict[str, Any]]:
        """The entries of a list of the result ("items", "boxes", "bodies", "events"), each as one flat dict: what pandas and
        csv read. Names of what is nested are joined with dots, numbers of a list counted from 0: "X_TP.p.2".

        Raises InputError for a key that holds no list of entries.
        """
        entries = self.get(key)
        if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
            lists = [name for name, value in self.items() if isinstance(value, list) and isinstance((value or [{}])[0], dict)]
            raise refused("key", f"'{key}'", f"a list of entries: {', '.join(lists)}")
        return [dict(_flat(entry)) for entry in entries]


def pack(scenario: _core.Scenario, sequence: str, *, agent: Any = "contact-aware", seed: Optional[int] = None,
         plant_seed: int = 1, decision_time: float = 0.5, samples: int = 8, threads: int = 0,
         robot: Optional[str] = None, perception: str = "exact", monte_carlo: int = 0, tempo: Optional[float] = 1.0,
         record: PathLike = "",
         progress: Optional[Callable[[int, int, int, float], None]] = None) -> Result:
    """Packs a sequence as `snug pack` does: decides, rehearses, sends motions to a simulated plant, looks, recovers.

    Args:
        scenario: with container, aligner and tool.
        sequence: name of one of its sequences.
        agent: name of a built-in agent (`agent_names()`), or an object with
            `decide(state, item, candidates)` (see snug.agent).
        seed: of roll-outs and samples; the scenario's by default.
        plant_seed: of the plant, a cell drawn from the scenario's `uncertainty`; 0: exactly what the scenario says.
        decision_time: s an item on one core; turned into work, so that results repeat.
        samples: worlds in which each motion is rehearsed beside the nominal one before it is sent; 0 .. 64.
        threads: 0: all cores. The result does not depend on it.
        robot: name of the scenario's robot, "none": the tool moves by itself; None: the robot where its file is there.
        perception: "exact", "noisy", "dead-reckoning" or "camera" (the scenario's first).
        monte_carlo: repeats the finished program so many times, open loop, in cells drawn anew.
        tempo: fraction of the speeds, 0.5 .. 1, of fast motions; None: with the demonstrator's lag (`--controller lagged`).
        record: HDF5 file for a recording of the plant's course, or "".
        progress: called as progress(item, items, packed, percent) after each item.

    Returns:
        planned_boxes, planned_percent, executed_boxes, executed_percent, items, ...; `.program` is what was executed.

    Raises:
        InputError: for an unknown sequence or agent, or a scenario that cannot be packed.
    """
    name = agent if isinstance(agent, str) else type(agent).__name__
    answer = None if isinstance(agent, str) else answerer(agent)
    words, program = _core.pack(scenario, sequence, name, answer, seed, plant_seed, decision_time, samples,
                                threads, robot, perception, monte_carlo, tempo, str(record), progress)
    result = Result(words)
    result.program = program
    return result


def simulate(scenario: _core.Scenario, program: Optional[_core.Program] = None, sequence: str = "", *,
             corrections: str = "", robot: str = "", cup: str = "", controller: Optional[str] = None,
             until: Optional[float] = None, record: PathLike = "") -> Result:
    """Runs a scenario, alone or with a program, as `snug simulate` does.

    Args:
        program: waypoints to run; None: bodies alone.
        sequence: that the program packs.
        corrections: layer of the scenario's site corrections, or "".
        robot: name of the scenario's robot; "": the tool moves by itself.
        cup: "phases" (pressure builds up and decays, holds can fail) or "holding" (attached and released at once);
            "": phases, with corrections the cup that they were made for.
        controller: "lagged" (the demonstrator's lag), "exact" or "fast"; None: as the program was packed.
        until: s; the program's end or the scenario's duration by default.
        record: HDF5 file, or "".

    Returns:
        Of a program boxes with what became of each; of a scene bodies with pose and speed; contacts, solver.
        `failure` is "" or why the run had to stop.
    """
    return Result(_core.simulate(scenario, program, sequence, corrections, robot, cup, controller or "", until,
                                 str(record)))


class Recording(_core.Recording):
    """A recording (HDF5). Columns are read as arrays; in a notebook it shows itself as the report page."""

    def to_html(self, every: int = 1) -> str:
        """The report page with this recording inside, one file that opens anywhere; every n-th frame."""
        page = Path(__file__).with_name("page.html")
        if not page.exists():
            raise refused("page", "none: the module was built without the viewer", "a module with the viewer's page")
        return self.page(page.read_text(encoding="utf-8"), every)

    def _repr_html_(self) -> str:
        return (f'<iframe srcdoc="{html.escape(self.to_html(), quote=True)}" width="100%" height="700" '
                'style="border: 0" sandbox="allow-scripts"></iframe>')


def report(recording: Union[PathLike, Recording], output: PathLike, *, every: int = 1) -> Path:
    """Writes the report page of a recording, one HTML file with replay, item events and plots; returns its path."""
    source = recording if isinstance(recording, Recording) else Recording(recording)
    path = Path(output)
    _core.write_file(path, source.to_html(every))
    return path
