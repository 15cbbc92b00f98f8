# What the compiled part offers. Units are SI and radians; poses are [x, y, z, qw, qx, qy, qz] in m.
import os
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple, Type, Union

import numpy as np

_Path = Union[str, "os.PathLike[str]"]
_Array = Any  # whatever numpy makes an array of numbers from

__version__: str

class Scenario:
    """What a scenario file says; nobody changes it."""

    def __init__(self) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def source(self) -> str:
        """The file, or what stood for it."""
    @property
    def text(self) -> str:
        """The whole file, changes included."""
    @property
    def time_step(self) -> float:
        """s"""
    @property
    def duration(self) -> float:
        """s, of a run without a program."""
    @property
    def seed(self) -> int: ...
    @property
    def sequences(self) -> Dict[str, List[str]]:
        """Ids of the parcels of each sequence, in their order."""
    @property
    def parcels(self) -> List[Dict[str, Any]]:
        """id, type, size [m, along Px, Py, Pz], mass [kg], com [m, in P]."""
    @property
    def container(self) -> Optional[Dict[str, Any]]:
        """The one to be packed: name, inner_size [m], pose X_WT, walls; None without."""
    def with_values(self, values: Dict[str, Any]) -> Scenario:
        """The scenario with keys set, such as {"cup.lip_radius": 0.03, "contacts.pairs.box/container.friction": 0.1}.

        Entries of lists by index, name or id. Raises InputError for what the reader of scenarios refuses.
        """
    def with_container(self, words: str) -> Scenario:
        """Another target: a container of the scenario by name, or an open box "LxWxH" in mm."""
    def with_pallet(self, words: str) -> Scenario:
        """A slab without walls, "LxW" or "LxWxH" in mm, as the target."""
    def with_items(self, items: Any) -> Scenario:
        """With the boxes and sequences of a file: orders (.csv, .json) or items (.yaml); or of a table of orders: a DataFrame of
        pandas or a list of dicts or dataclasses with the columns order, article, length_mm, width_mm, height_mm, mass_kg and so on
        (docs/formats.md, orders)."""
    def __eq__(self, other: object) -> bool: ...

class Program:
    """Waypoints of the tool with switches."""

    def __init__(self) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def rows(self) -> List[Dict[str, Any]]:
        """name, pose X_WE, vacuum, blow_off."""
    def to_csv(self) -> str:
        """The 13-column form of docs/formats.md."""
    def save(self, path: _Path) -> None: ...
    def __len__(self) -> int: ...

class WorldSnapshot:
    """All that changes of a World."""

    def __init__(self) -> None: ...
    @property
    def hash(self) -> int: ...

class CellSnapshot:
    """All that changes of a Cell."""

    def __init__(self) -> None: ...
    @property
    def steps(self) -> int:
        """Physics steps done."""

class World:
    """The bodies of a scenario without a robot: free ones, springs, drops; stepped one time step at a time."""

    def __init__(self, scenario: Scenario) -> None: ...
    def step(self, steps: int = ...) -> None:
        """Advances by `steps` time steps. Raises RuntimeError when the physics has to stop."""
    def snapshot(self) -> WorldSnapshot: ...
    def restore(self, snapshot: WorldSnapshot) -> None:
        """Goes back to a snapshot of this world, or of another of the same scenario."""
    def set_pose(self, name: str, pose: _Array) -> None:
        """Moves a body to X_WB, keeps its velocity, wakes it."""
    def set_twist(self, name: str, linear: _Array, angular: _Array) -> None:
        """m/s at the body's origin and rad/s, in W; wakes it."""
    @property
    def dt(self) -> float:
        """s"""
    @property
    def scenario(self) -> Scenario: ...
    @property
    def hash(self) -> int:
        """Over every byte that has an influence on what comes."""
    @property
    def report(self) -> Dict[str, Any]:
        """Of the last step: status, sweeps, residual [m/s], contacts, awake, worst_penetration [m]."""
    @property
    def positions(self) -> np.ndarray:
        """View (n, 3): centres of mass in W, m."""
    @property
    def quaternions_xyzw(self) -> np.ndarray:
        """View (n, 4): orientations of the bodies in W, the real part last."""
    @property
    def velocities(self) -> np.ndarray:
        """View (n, 3): of the centres of mass in W, m/s."""
    @property
    def angular_velocities(self) -> np.ndarray:
        """View (n, 3): in W, rad/s."""
    @property
    def present(self) -> np.ndarray:
        """View (n,), bool: bodies that are not in the scene (yet, or any more) are False."""
    @property
    def names(self) -> List[str]: ...
    def poses(self, out: Optional[np.ndarray] = ...) -> np.ndarray:
        """(n, 7): poses X_WB of the body frames; a new array, or `out`."""
    def pose(self, name: str) -> np.ndarray:
        """X_WB of one body."""
    def contacts(self) -> List[Dict[str, Any]]:
        """Points that bear a force: bodies (a, b), point [m, W], normal [a to b], force on b [N, W], gap [m], slides."""
    @property
    def time(self) -> float:
        """s, simulated."""
    @property
    def kinetic_energy(self) -> float:
        """J"""

class Cell:
    """The robot's cell under way with a program, one tick of its controller at a time.

    cup: "phases", "holding" (attached and released at once), or "": phases, with corrections the cup that they were made
    for; controller: "lagged", "exact", "fast", or "": as the program was packed; robot: name of the scenario's robot, or
    "": the tool moves by itself; corrections: layer of the scenario's site corrections, or "".
    """

    def __init__(self, scenario: Scenario, sequence: str, program: Program, *, cup: str = ..., controller: str = ...,
                 robot: str = ..., corrections: str = ...) -> None: ...
    def step(self, ticks: int = ...) -> bool:
        """Advances by `ticks` ticks; False when the program has ended. Raises RuntimeError with body, time and
        contacts when the run has to stop (a protective stop of the robot, say)."""
    def run(self) -> None:
        """To the end of the program."""
    def snapshot(self) -> CellSnapshot: ...
    def restore(self, snapshot: CellSnapshot) -> None: ...
    @property
    def scenario(self) -> Scenario: ...
    @property
    def tick(self) -> float:
        """s, of the controller: some physics steps."""
    @property
    def has_ended(self) -> bool: ...
    @property
    def row(self) -> int:
        """Of the program, aimed at; -1 before the first."""
    @property
    def tool(self) -> np.ndarray:
        """X_WE as commanded."""
    @property
    def cup(self) -> Dict[str, Any]:
        """phase, pressure_gauge [Pa, vacuum negative], holds (a name or None), bend [rad], wrench on the box [in S]."""
    @property
    def joints(self) -> Optional[np.ndarray]:
        """rad; None without a robot."""
    def boxes(self) -> List[Dict[str, Any]]:
        """What became of each box of the sequence so far: id, state, pose X_TP, up, outside [m], above_rim [m], events."""
    def events(self) -> List[Dict[str, Any]]: ...
    @property
    def hash(self) -> int: ...
    @property
    def positions(self) -> np.ndarray:
        """View (n, 3): centres of mass in W, m."""
    @property
    def quaternions_xyzw(self) -> np.ndarray:
        """View (n, 4): orientations in W, the real part last."""
    @property
    def velocities(self) -> np.ndarray:
        """View (n, 3): of the centres of mass in W, m/s."""
    @property
    def angular_velocities(self) -> np.ndarray:
        """View (n, 3): in W, rad/s."""
    @property
    def present(self) -> np.ndarray:
        """View (n,), bool."""
    @property
    def names(self) -> List[str]: ...
    def poses(self, out: Optional[np.ndarray] = ...) -> np.ndarray:
        """(n, 7): poses X_WB of the body frames; a new array, or `out`."""
    def pose(self, name: str) -> np.ndarray: ...
    def contacts(self) -> List[Dict[str, Any]]: ...
    @property
    def time(self) -> float:
        """s, simulated."""
    @property
    def kinetic_energy(self) -> float:
        """J"""

class Cup:
    def __init__(self, scenario: Scenario) -> None: ...
    @property
    def stiffness(self) -> np.ndarray:
        """K (6, 6) in S1, linear part first, N/m and Nm/rad."""
    @property
    def damping(self) -> np.ndarray:
        """D (6, 6) in S1."""
    @property
    def hold_length(self) -> float:
        """m, from E to the lip under vacuum."""
    @property
    def lip_radius(self) -> float:
        """m"""
    def wrench(self, H: _Array) -> np.ndarray:
        """Of the spring on the load, in S1 about its origin, for the deformation H = X_S2S1."""
    def tangent(self, H: _Array) -> np.ndarray:
        """(6, 6), derivative of `wrench` by the body twist of S1 in S2."""
    def potential(self, H: _Array) -> float:
        """J"""
    def settle(self, mass: float, com: _Array, tool: _Array, gravity: _Array) -> Dict[str, Any]: ...
    def payload(self, times: _Array, gripper: _Array, wrenches: _Array, rigid_lip: bool = ...) -> Dict[str, Any]: ...

class Arm:
    """An arm from a scenario's robot or a URDF."""

    def __init__(self, scenario: Scenario) -> None: ...
    @staticmethod
    def from_urdf(path: _Path, tool_frame: str = ...) -> Arm: ...
    @property
    def name(self) -> str: ...
    @property
    def joints(self) -> List[str]: ...
    @property
    def lower(self) -> np.ndarray:
        """rad"""
    @property
    def upper(self) -> np.ndarray:
        """rad"""
    @property
    def max_speed(self) -> np.ndarray:
        """rad/s"""
    def forward(self, q: _Array) -> np.ndarray:
        """X_WE at joints q [rad]."""
    def jacobian(self, q: _Array) -> np.ndarray:
        """(6, n): twist of E in W for unit speed of each joint, linear part first."""
    def inverse(self, pose: _Array, near: _Array) -> Optional[np.ndarray]:
        """Joints within their limits that bring E to X_WE, nearest to `near`; None when there are none."""
    def branches(self, pose: _Array, near: _Array) -> List[np.ndarray]:
        """All ways to reach it, limits not looked at."""

class Packer:
    """A built-in agent and the container that it packs without executing. `sequence` is known to the agent "offline" alone."""

    def __init__(self, scenario: Scenario, agent: str = ..., *, sequence: str = ..., seed: int = ...,
                 decision_time: float = ...) -> None: ...
    def decide(self, parcel: str) -> Union[List[Dict[str, Any]], str]:
        """Candidates for a parcel of the scenario, best first; a word such as "no space left" when there is none."""
    def place(self, parcel: str, candidate: int = ...) -> None:
        """Takes one of the candidates that decide() returned last."""
    @property
    def percent(self) -> float:
        """Filling degree."""
    def boxes(self) -> List[Dict[str, Any]]:
        """id, size, pose X_TP."""

class Recording:
    """A recording (HDF5)."""

    def __init__(self, path: _Path) -> None: ...
    @property
    def file(self) -> str: ...
    @property
    def names(self) -> List[str]:
        """Of the bodies."""
    @property
    def bodies(self) -> List[Dict[str, Any]]:
        """name, type, kind ("static", "kinematic", "dynamic"), mass [kg], shapes: each with kind ("box", "capsule", "cylinder",
        "hull"), pose in the body, and size (edges), radius and length along z (without the ends of a capsule), or vertices and
        triangles, m."""
    @property
    def joint_names(self) -> List[str]: ...
    @property
    def sequence(self) -> str: ...
    @property
    def scenario_text(self) -> str: ...
    @property
    def program_text(self) -> str: ...
    @property
    def version(self) -> str: ...
    @property
    def is_complete(self) -> bool:
        """False for a run that was killed, goes on, or was interrupted."""
    @property
    def times(self) -> np.ndarray:
        """s, of every frame."""
    @property
    def result(self) -> Optional[Dict[str, Any]]:
        """What became of the run."""
    @property
    def events(self) -> List[Dict[str, Any]]: ...
    def read(self, every: int = ...) -> Dict[str, np.ndarray]:
        """Columns of every n-th frame: time [s], row, poses (t, n, 7), twists (t, n, 6; at the body's origin, in W),
        present (t, n), tool (t, 7), pressure_gauge [Pa], cup_wrench (t, 6; on the box, in S), flange_wrench (t, 6),
        joints (t, j)."""
    def page(self, page: str, every: int = ...) -> str: ...

class Environment:
    def __init__(self, scenario: Scenario, settings: Dict[str, Any], parameters: Dict[str, Any], maps: bool,
                 boxes: bool) -> None: ...
    def reset(self, seed: int) -> Dict[str, np.ndarray]: ...
    def observe(self) -> Dict[str, np.ndarray]: ...
    def step_candidate(self, index: int) -> Tuple[Dict[str, np.ndarray], float, bool, bool, str, float, bool]: ...
    def step_place(self, orientation: int, x: float,
                   y: float) -> Tuple[Dict[str, np.ndarray], float, bool, bool, str, float, bool]: ...
    def copy(self) -> Environment: ...
    @property
    def rows(self) -> int: ...
    @property
    def columns(self) -> int: ...
    @property
    def most_boxes(self) -> int: ...
    @property
    def max_candidates(self) -> int: ...
    @property
    def candidates(self) -> int: ...
    @property
    def has_ended(self) -> bool: ...
    @property
    def next(self) -> int: ...
    @property
    def items(self) -> List[str]: ...
    def boxes(self) -> List[Dict[str, Any]]: ...
    @property
    def packed_percent(self) -> float: ...
    @property
    def time(self) -> float: ...
    @property
    def hash(self) -> int: ...

_Batch = Tuple[Dict[str, np.ndarray], np.ndarray, np.ndarray, np.ndarray]

class VectorEnvironment:
    def __init__(self, scenarios: Sequence[Scenario], settings: Sequence[Dict[str, Any]],
                 parameters: Sequence[Dict[str, Any]], threads: int, maps: bool, boxes: bool) -> None: ...
    def reset(self, mask: _Array, seeds: _Array) -> Dict[str, np.ndarray]:
        """Those of the mask begin anew, all are observed."""
    def step_candidates(self, actions: _Array, next_seeds: _Array) -> _Batch:
        """next_seeds: of the episodes that begin in this step."""
    def step_places(self, actions: _Array, next_seeds: _Array) -> _Batch: ...
    @property
    def candidates(self) -> List[int]: ...
    @property
    def rows(self) -> int: ...
    @property
    def columns(self) -> int: ...
    @property
    def most_boxes(self) -> int: ...
    @property
    def max_candidates(self) -> int: ...
    @property
    def reasons(self) -> List[str]: ...
    @property
    def packed_percent(self) -> np.ndarray: ...
    @property
    def hashes(self) -> List[int]: ...

def set_input_error(type: Type[Exception]) -> None: ...
def as_pose(transform: _Array) -> np.ndarray: ...
def agent_names() -> List[str]:
    """Built-in agents."""
def load_scenario(words: str, shipped: _Path) -> Scenario:
    """Reads a scenario by file, or by name from those in the folder `shipped`."""
def list_scenarios(shipped: _Path) -> List[str]:
    """Names of the scenarios in a folder."""
def parse_scenario(text: str, name: str = ...) -> Scenario:
    """The same from text; `name` stands for the file in messages."""
def load_program(path: _Path) -> Program:
    """Reads a program in the 13-column form."""
def parse_program(text: str, name: str = ...) -> Program: ...
def write_file(path: _Path, text: str) -> None: ...
def pack(scenario: Scenario, sequence: str, agent: str, answer: Optional[Callable[[str], str]], seed: Optional[int],
         plant_seed: int, decision_time: float, samples: int, threads: int, robot: Optional[str], perception: str,
         monte_carlo: int, tempo: Optional[float], record: _Path,
         progress: Optional[Callable[[int, int, int, float], None]]) -> Tuple[Dict[str, Any], Program]: ...
def simulate(scenario: Scenario, program: Optional[Program], sequence: str, corrections: str, robot: str, cup: str,
             controller: str, until: Optional[float], record: _Path) -> Dict[str, Any]: ...
