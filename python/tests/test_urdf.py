"""Public URDF files: each loads and has the tool where Pinocchio has it, or is refused naming the place.

SNUG_URDF_FOLDER: folder of URDF files, searched with all folders in it; SNUG_PINOCCHIO: a Python that has `pin` of PyPI
(scripts/test-urdf.sh makes one). Without a folder there is nothing to test: no files of others are part of the project.
"""
import json
import os
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

import snug

FOLDER = os.environ.get("SNUG_URDF_FOLDER", "")
PINOCCHIO = os.environ.get("SNUG_PINOCCHIO", "")
TOOLS = ("tool0", "flange", "ee_link", "tool_frame", "link_ee", "panda_link8", "lbr_iiwa_link_7", "iiwa_link_ee")
POSES = 20
TOLERANCE = 1e-9  # m and parts of a rotation's matrix; arms of 3 m and ten joints round to 1e-14


def find_tool(path):
    """The link that carries the tool: one of the usual names, else the leaf behind the most moving joints."""
    root = ElementTree.parse(path).getroot()
    up = {joint.find("child").get("link"): (joint.get("type") != "fixed", joint.find("parent").get("link"))
          for joint in root.findall("joint")}
    links = [link.get("name") for link in root.findall("link")]

    def moving(link):
        count, seen = 0, set()
        while link in up and link not in seen:
            seen.add(link)
            count += up[link][0]
            link = up[link][1]
        return count

    named = [link for link in TOOLS if link in links and moving(link) > 2]
    parents = {parent for _, parent in up.values()}
    return named[0] if named else max((link for link in links if link not in parents), key=moving, default="none")


def matrix(pose):
    """Rows of [R p] from p and quaternion (w first)."""
    w, x, y, z = pose[3:] / np.linalg.norm(pose[3:])
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), pose[0]],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), pose[1]],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), pose[2]]])


def judge(path, reference):
    """What becomes of a file, and a word about it."""
    try:
        tool = find_tool(path)
    except (ElementTree.ParseError, AttributeError, ValueError) as error:
        tool = "none"  # it is refused, too
    try:
        arm = snug.Arm.from_urdf(path, tool)
    except snug.InputError as error:
        return "refused", str(error)
    random = np.random.default_rng(1)
    low, high = (np.where(np.isfinite(bound), bound, end) for bound, end in ((arm.lower, -np.pi), (arm.upper, np.pi)))
    q = random.uniform(low, high, (POSES, len(low)))
    reference.stdin.write(json.dumps({"path": str(path), "tool": tool, "joints": arm.joints, "q": q.tolist()}) + "\n")
    reference.stdin.flush()
    answer = json.loads(reference.stdout.readline())
    if "error" in answer:
        return "not compared", answer["error"]
    error = max(np.abs(matrix(arm.forward(one)).reshape(-1) - theirs).max() for one, theirs in zip(q, answer["poses"]))
    return ("loaded" if error <= TOLERANCE else "wrong"), f"tool {tool}, {len(low)} joints, {error:.1e}"


@pytest.mark.skipif(not FOLDER, reason="SNUG_URDF_FOLDER names no folder of URDF files")
@pytest.mark.skipif(not PINOCCHIO, reason="SNUG_PINOCCHIO names no Python that has Pinocchio")
def test_public_files_load_or_are_refused_naming_the_place():
    files = sorted(path for path in Path(FOLDER).rglob("*") if path.suffix.lower() == ".urdf")
    assert files, FOLDER
    counts, wrong = Counter(), []
    with subprocess.Popen([PINOCCHIO, Path(__file__).with_name("urdf_reference.py")], text=True,
                          stdin=subprocess.PIPE, stdout=subprocess.PIPE) as reference:
        for path in files:
            kind, word = judge(path, reference)
            counts[kind] += 1
            print(kind, path.relative_to(FOLDER), word, sep="\t")
            place = re.match(r"(?:\.\.\.)?(.*):\d+: ", word)  # a long path is cut at its beginning
            if kind == "wrong" or (kind == "refused" and not (place and str(path).endswith(place[1]))):
                wrong.append((path, word))
        reference.stdin.close()
    print(dict(counts), file=sys.stderr)
    assert not wrong
    assert counts["loaded"] > 0
