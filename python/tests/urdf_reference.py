"""Tool poses of URDF files by Pinocchio, in a process of its own: its numpy need not be that of snug.

Reads lines {"path", "tool", "joints": [names], "q": [[rad or m]]} of JSON, writes a line for each: {"poses": [12 numbers each, rows of [R p]]} or
{"error": text}.
"""
import json
import math
import sys

import pinocchio


def poses(path, tool, joints, q):
    try:
        model = pinocchio.buildModelFromUrdf(path, mimic=True)
    except ValueError:  # it knows no chains of joints that mimic, nor leaders off the path: then they all move by themselves
        model = pinocchio.buildModelFromUrdf(path)
    data, frame = model.createData(), model.getFrameId(tool, pinocchio.FrameType.BODY)
    found = []
    for values in q:
        state = pinocchio.neutral(model)
        for name, value in zip(joints, values):
            joint = model.joints[model.getJointId(name)]
            if joint.nq == 2:  # continuous: cosine and sine
                state[joint.idx_q:joint.idx_q + 2] = [math.cos(value), math.sin(value)]
            else:
                state[joint.idx_q] = value
        pinocchio.framesForwardKinematics(model, data, state)
        found.append([float(x) for x in data.oMf[frame].homogeneous[:3].reshape(-1)])
    return found


for line in sys.stdin:
    try:
        answer = {"poses": poses(**json.loads(line))}
    except Exception as error:  # whatever it does not like
        answer = {"error": str(error)[:200]}
    print(json.dumps(answer), flush=True)
