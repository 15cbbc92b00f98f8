"""What a worker of bench_peers answers: one line of JSON for each line that it reads.

A worker derives from `Engine` and calls `serve`. Poses are [x, y, z, qw, qx, qy, qz] in W, velocities [v, w] in W with v at
the centre of the body, SI units. A body of mass 0 is fixed. "moments", where not null, are about its axes, and "middle" is
where its shape is from its centre of mass. Questions:

    {"build": SCENE}                          a new scene, at rest; the answer is the state
    {"do": [ACT, ...]}                        in this order; the answer is the state
    {"normal_force": [A, B]}                  N, summed over the last step; -1 is the plane

The answer to a question that failed is {"error"}.

ACT is {"steps": N}, {"steps": N, "follow": BODY}, {"set": BODY, "pose", "velocity"}, {"insert": BODY, "pose", "velocity"} or
{"push": BODY, "force", "torque"}: a wrench about the centre of the body during the next step. A state is {"poses",
"velocities", "cpu", "failed"}; "cpu" is the processor time of this process that steps took, s. After steps that followed a
body it has "path", too: the body's pose after each, up to the first that is not finite.
"""

import json
import math
import os
import sys
import time
import traceback

PLANE = -1


class Engine:
    """One engine with one scene. `self.scene` is as bench_peers sent it."""

    takes_moments = False  # of bodies that are no solid boxes, with their centre of mass aside

    def build(self, scene):
        raise NotImplementedError

    def step(self):
        raise NotImplementedError

    def push(self, body, force, torque):
        raise NotImplementedError

    def set_motion(self, body, pose, velocity):
        raise NotImplementedError

    def motion(self, body):
        """(pose, velocity), lists of 7 and 6."""
        raise NotImplementedError

    def normal_force(self, body_a, body_b):
        """None: the engine does not tell."""
        return None

    def parked(self, body):
        """Where a body waits that has not entered yet: far from the others, at rest. Engines whose bodies cannot be added
        later have it there from the start and hold it there."""
        return [10.0 + body, 0.0, 100.0, 1.0, 0.0, 0.0, 0.0], [0.0] * 6


def state(engine, cpu):
    poses, velocities = [], []
    for i, body in enumerate(engine.scene["bodies"]):
        pose, velocity = (body["pose"], [0.0] * 6) if body["mass"] == 0 else engine.motion(i)
        poses.append([float(x) for x in pose])
        velocities.append([float(x) for x in velocity])
    failed = not all(math.isfinite(x) for row in poses + velocities for x in row)
    if failed:
        poses = [body["pose"] for body in engine.scene["bodies"]]
        velocities = [[0.0] * 6 for _ in poses]
    return {"poses": poses, "velocities": velocities, "cpu": cpu, "failed": failed}


def serve(engine):
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what packages print is no answer
    cpu, absent = 0.0, set()
    for line in sys.stdin:
        question = json.loads(line)
        try:
            if "build" in question:
                engine.scene = question["build"]
                absent = {i for i, body in enumerate(engine.scene["bodies"]) if not body["present"]}
                for i in absent:
                    engine.scene["bodies"][i]["pose"] = engine.parked(i)[0]
                if not engine.takes_moments and any(body.get("moments") for body in engine.scene["bodies"]):
                    raise ValueError("this worker takes solid bodies alone")
                engine.build(engine.scene)
                cpu = 0.0
            acts = question.get("do", [])
            path = []
            for act in acts:
                if "set" in act or "insert" in act:
                    body = act.get("set", act.get("insert"))
                    absent.discard(body)
                    engine.set_motion(body, act["pose"], act["velocity"])
                elif "push" in act:
                    engine.push(act["push"], act["force"], act["torque"])
                for _ in range(act.get("steps", 0)):
                    for body in absent:
                        engine.set_motion(body, *engine.parked(body))
                    begin = time.process_time()
                    engine.step()
                    cpu += time.process_time() - begin
                    if "follow" in act:
                        pose = [float(x) for x in engine.motion(act["follow"])[0]]
                        if not all(map(math.isfinite, pose)):
                            break
                        path.append(pose)
            if "normal_force" in question:
                answer = {"normal_force": engine.normal_force(*question["normal_force"])}
            else:
                answer = state(engine, cpu)
                if any("follow" in act for act in acts):
                    answer["path"] = path
        except Exception:
            answer = {"error": traceback.format_exc().strip()}
        answers.write(json.dumps(answer) + "\n")
        answers.flush()
