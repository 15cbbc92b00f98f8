"""Recordings for other programs, through packages of theirs that need not be installed: Rerun, USD."""
from __future__ import annotations

import importlib
import os
from pathlib import Path
from typing import Any, Dict, Iterator, List, Set, Tuple, Union

import numpy as np

from ._errors import refused
from ._results import PathLike, Recording
from ._tools import matrix

_COLORS = {"dynamic": (0.82, 0.66, 0.44), "kinematic": (0.25, 0.28, 0.32), "static": (0.62, 0.64, 0.66)}


def _package(module: str, extra: str) -> Any:
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise ImportError(f"{module} is not installed: pip install snug[{extra}]") from error


def _opened(recording: Union[PathLike, Recording], every: int) -> Tuple[Recording, Dict[str, np.ndarray]]:
    source = recording if isinstance(recording, Recording) else Recording(recording)
    columns = source.read(every)
    if len(columns["time"]) == 0:
        raise refused("recording", f"'{source.file}' without frames", "at least one frame")
    return source, columns


def _draft(output: PathLike, endings: Tuple[str, ...]) -> Tuple[Path, Path]:
    """Where the file belongs, and beside it where it grows: its ending says the format."""
    path = Path(output)
    if path.suffix not in endings:
        raise refused("output", f"'{path}'", f"a name that ends in {' or '.join(endings)}")
    return path, path.with_name(f"{path.stem}.snug-part{path.suffix}")


def _presences(present: np.ndarray) -> Iterator[Tuple[int, int]]:
    """Rows [first, end) in which something is there."""
    edges = np.flatnonzero(np.diff(present.astype(int), prepend=0, append=0))
    yield from ((int(first), int(end)) for first, end in zip(edges[::2], edges[1::2]))


def _changes(poses: np.ndarray) -> np.ndarray:
    """Rows that say all: between two of them the pose does not change, or each is there."""
    same = (poses[1:] == poses[:-1]).all(axis=1)
    kept = np.ones(len(poses), dtype=bool)
    kept[1:-1] = ~(same[:-1] & same[1:])
    return np.flatnonzero(kept)


def to_rerun(recording: Union[PathLike, Recording], output: PathLike, *, every: int = 1) -> Path:
    """Writes a recording for the viewer of Rerun (.rrd), by its SDK (`pip install snug[rerun]`).

    On the timeline "time", s: W/NAME, each body with its shapes while it is there; W/E, the tool; cup/pressure_gauge, Pa;
    cup/wrench and flange/wrench (fx, fy, fz in N, tx, ty, tz in Nm); joints/NAME, rad or m; events.

    Args:
        recording: a recording or its file.
        output: the file to write; one that is there is replaced.
        every: every n-th frame.

    Returns the path. Raises ImportError without the SDK, InputError for a recording without frames or another ending.
    """
    rr = _package("rerun", "rerun")
    source, columns = _opened(recording, every)
    path, draft = _draft(output, (".rrd",))
    time = columns["time"]
    stream = rr.RecordingStream("snug")
    stream.save(str(draft))
    stream.log("W", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    for index, body in enumerate(source.bodies):
        entity = rr.new_entity_path(["W", body["name"]])
        present = columns["present"][:, index]
        is_lasting = bool(present.all())
        for first, end in _presences(present):
            if not is_lasting:
                stream.set_time("time", duration=float(time[first]))
            for number, shape in enumerate(body["shapes"]):
                stream.log(f"{entity}/{number}", *_rerun_shape(rr, shape, _COLORS[body["kind"]]), static=is_lasting)
            rows = first + _changes(columns["poses"][first:end, index])
            _send_poses(rr, stream, entity, time[rows], columns["poses"][rows, index])
            if end < len(time):
                stream.set_time("time", duration=float(time[end]))
                stream.log(entity, rr.Clear(recursive=True))
    _send_poses(rr, stream, "W/E", time, columns["tool"])
    numbers = {"cup/pressure_gauge": columns["pressure_gauge"]}
    for name in ("cup", "flange"):
        for k, part in enumerate(("fx", "fy", "fz", "tx", "ty", "tz")):
            numbers[f"{name}/wrench/{part}"] = columns[f"{name}_wrench"][:, k]
    for k, joint in enumerate(source.joint_names):
        numbers[rr.new_entity_path(["joints", joint])] = columns["joints"][:, k]
    for entity, values in numbers.items():
        rr.send_columns(entity, indexes=[rr.TimeColumn("time", duration=time)], columns=rr.Scalars.columns(scalars=values),
                        recording=stream)
    for event in source.events:
        stream.set_time("time", duration=float(event["time"]))
        text = " ".join(word for word in (event["kind"], event["body"], event["text"]) if word)
        stream.log("events", rr.TextLog(text))
    stream.disconnect()
    os.replace(draft, path)
    return path


def _send_poses(rr: Any, stream: Any, entity: str, time: np.ndarray, poses: np.ndarray) -> None:
    rr.send_columns(entity, indexes=[rr.TimeColumn("time", duration=time)], recording=stream,
                    columns=rr.Transform3D.columns(translation=poses[:, :3], quaternion=poses[:, [4, 5, 6, 3]]))


def _rerun_shape(rr: Any, shape: Dict[str, Any], color: Tuple[float, ...]) -> List[Any]:
    """What is logged of a shape: where it is in its body, and its form, about the middle."""
    pose = shape["pose"]
    where = rr.Transform3D(translation=pose[:3], mat3x3=matrix(pose)[:3, :3])
    solid = rr.components.FillMode.Solid
    if shape["kind"] == "box":
        return [where, rr.Boxes3D(sizes=[shape["size"]], colors=[color], fill_mode=solid)]
    if shape["kind"] == "capsule":  # which begins at its own origin
        return [where, rr.Capsules3D(lengths=[shape["length"]], radii=[shape["radius"]], colors=[color],
                                     translations=[[0.0, 0.0, -0.5 * shape["length"]]])]
    vertices, triangles = shape.get("vertices", []), shape.get("triangles", [])
    if shape["kind"] == "cylinder":
        vertices, triangles = _prism(shape["radius"], shape["length"])
    return [where, rr.Mesh3D(vertex_positions=vertices, triangle_indices=triangles, albedo_factor=color)]


def _prism(radius: float, length: float, sides: int = 32) -> Tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of a cylinder about z, turned outwards: the middles of its ends come last."""
    angles = 2.0 * np.pi * np.arange(sides) / sides
    ring = np.column_stack((radius * np.cos(angles), radius * np.sin(angles)))
    ends = [np.column_stack((ring, np.full(sides, z))) for z in (-0.5 * length, 0.5 * length)]
    i, j = np.arange(sides), (np.arange(sides) + 1) % sides
    low, high = np.full(sides, 2 * sides), np.full(sides, 2 * sides + 1)
    triangles = [(i, j, sides + j), (i, sides + j, sides + i), (low, j, i), (high, sides + i, sides + j)]
    vertices = np.vstack((*ends, [[0.0, 0.0, -0.5 * length], [0.0, 0.0, 0.5 * length]]))
    return vertices, np.vstack([np.column_stack(corners) for corners in triangles])


def to_usd(recording: Union[PathLike, Recording], output: PathLike, *, every: int = 1) -> Path:
    """Writes a recording as a stage of USD (.usda text, .usdc or .usd binary), by usd-core (`pip install snug[usd]`).

    z up, m. /W/NAME is each body with its shapes below it: pose as time samples of a translation and an orientation, visibility
    while it is there; /W/E the tool. Characters that names of USD do not have become "_"; display names are whole. Time codes
    are the frames of the recording: `timeCodesPerSecond` is one over the time between them. Samples that say nothing new are
    left out.

    Args:
        recording: a recording or its file.
        output: the file to write; one that is there is replaced.
        every: every n-th frame.

    Returns the path. Raises ImportError without the package, InputError for a recording without frames or another ending.
    """
    pxr = {name: _package(f"pxr.{name}", "usd") for name in ("Gf", "Sdf", "Tf", "Usd", "UsdGeom")}
    source, columns = _opened(recording, every)
    path, draft = _draft(output, (".usda", ".usdc", ".usd"))
    time = columns["time"]
    rate = round(float(1.0 / np.median(np.diff(time))), 6) if len(time) > 1 else 24.0
    codes = time * rate
    stage = pxr["Usd"].Stage.CreateInMemory()
    pxr["UsdGeom"].SetStageUpAxis(stage, pxr["UsdGeom"].Tokens.z)
    pxr["UsdGeom"].SetStageMetersPerUnit(stage, 1.0)
    stage.SetTimeCodesPerSecond(rate)
    stage.SetFramesPerSecond(rate)
    stage.SetStartTimeCode(float(codes[0]))
    stage.SetEndTimeCode(float(codes[-1]))
    stage.SetDefaultPrim(pxr["UsdGeom"].Xform.Define(stage, "/W").GetPrim())
    taken = {"E"}
    for index, body in enumerate(source.bodies):
        prim = pxr["UsdGeom"].Xform.Define(stage, f"/W/{_usd_name(pxr, body['name'], taken)}")
        prim.GetPrim().SetDisplayName(body["name"])
        present = columns["present"][:, index]
        visibility = prim.CreateVisibilityAttr()
        if not present.all():
            for first in np.flatnonzero(np.diff(present.astype(int), prepend=1 - int(present[0]))):
                visibility.Set("inherited" if present[first] else "invisible", float(codes[first]))
        rows = [first + _changes(columns["poses"][first:end, index]) for first, end in _presences(present)]
        kept = np.concatenate(rows) if rows else np.zeros(0, dtype=int)
        _usd_poses(pxr, prim, codes[kept], columns["poses"][kept, index])
        for number, shape in enumerate(body["shapes"]):
            _usd_shape(pxr, stage, f"{prim.GetPath()}/shape_{number}", shape, _COLORS[body["kind"]])
    kept = _changes(columns["tool"])
    _usd_poses(pxr, pxr["UsdGeom"].Xform.Define(stage, "/W/E"), codes[kept], columns["tool"][kept])
    stage.GetRootLayer().Export(str(draft))
    os.replace(draft, path)
    return path


def _usd_name(pxr: Dict[str, Any], name: str, taken: Set[str]) -> str:
    base = pxr["Tf"].MakeValidIdentifier(name)
    unique, number = base, 1
    while unique in taken:
        number += 1
        unique = f"{base}_{number}"
    taken.add(unique)
    return str(unique)


def _usd_poses(pxr: Dict[str, Any], prim: Any, codes: np.ndarray, poses: np.ndarray) -> None:
    """Samples; one pose alone without time."""
    move = prim.AddTranslateOp(pxr["UsdGeom"].XformOp.PrecisionDouble)
    turn = prim.AddOrientOp(pxr["UsdGeom"].XformOp.PrecisionDouble)
    if len(poses) == 0:
        return
    flips = np.sign((poses[1:, 3:] * poses[:-1, 3:]).sum(axis=1))  # the shorter way between samples
    turns = poses[:, 3:] * np.cumprod(np.concatenate((np.ones(1), np.where(flips < 0.0, -1.0, 1.0))))[:, np.newaxis]
    moves = [pxr["Gf"].Vec3d(*p) for p in poses[:, :3].tolist()]
    quaternions = [pxr["Gf"].Quatd(*q) for q in turns.tolist()]
    if bool((poses == poses[0]).all()):
        move.Set(moves[0])
        turn.Set(quaternions[0])
        return
    layer = prim.GetPrim().GetStage().GetRootLayer()
    places = [op.GetAttr().GetPath() for op in (move, turn)]
    with pxr["Sdf"].ChangeBlock():  # a stage that hears of every sample takes four times as long
        for code, p, q in zip(codes.tolist(), moves, quaternions):
            layer.SetTimeSample(places[0], code, p)
            layer.SetTimeSample(places[1], code, q)


def _usd_shape(pxr: Dict[str, Any], stage: Any, path: str, shape: Dict[str, Any], color: Tuple[float, ...]) -> None:
    geometry = pxr["UsdGeom"]
    pose = np.asarray(shape["pose"])
    if shape["kind"] == "box":
        prim = geometry.Cube.Define(stage, path)
        prim.CreateSizeAttr(1.0)
        prim.CreateExtentAttr([(-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)])
    elif shape["kind"] == "hull":
        prim = geometry.Mesh.Define(stage, path)
        triangles = shape.get("triangles", [])
        prim.CreatePointsAttr([tuple(vertex) for vertex in shape.get("vertices", [])])
        prim.CreateFaceVertexCountsAttr([3] * len(triangles))
        prim.CreateFaceVertexIndicesAttr([corner for triangle in triangles for corner in triangle])
        prim.CreateSubdivisionSchemeAttr(geometry.Tokens.none)
    else:
        prim = (geometry.Capsule if shape["kind"] == "capsule" else geometry.Cylinder).Define(stage, path)
        prim.CreateAxisAttr(geometry.Tokens.z)
        prim.CreateRadiusAttr(float(shape["radius"]))
        prim.CreateHeightAttr(float(shape["length"]))
        high = np.array([shape["radius"], shape["radius"],
                         0.5 * shape["length"] + (shape["radius"] if shape["kind"] == "capsule" else 0.0)])
        prim.CreateExtentAttr([tuple(map(float, -high)), tuple(map(float, high))])
    prim.CreateDisplayColorAttr([color])
    _usd_poses(pxr, prim, np.zeros(1), pose[np.newaxis, :])
    if shape["kind"] == "box":
        prim.AddScaleOp(geometry.XformOp.PrecisionDouble).Set(pxr["Gf"].Vec3d(*map(float, shape["size"])))
