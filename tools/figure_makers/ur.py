"""Tables of sessions through a served UR, beside the same sessions in one process."""
import json
import signal
import statistics
import subprocess
import tempfile
import threading

from figure_makers.common import ROOT, SCENARIO, SEQUENCES, CannotMake, commit, origin, run

UR_PACK = ["--samples", "0", "--decision-time", "0.2"]
UR_PLANTS = (1, 2, 3)


def serve_ur(words, sequence, plant, boxes):
    """A served UR at ports that are free; its process, and what is added to its ports."""
    for offset in range(4000, 9000, 100):
        served = subprocess.Popen([str(words.snug), "serve", SCENARIO, "--sequence", sequence, "--plant-seed", str(plant), "--ur", "127.0.0.1",
                                   "--ur-port-offset", str(offset), "--observers", boxes], cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        said = served.stderr.readline()
        if "serving" in said:
            return served, offset
        served.wait()
    raise CannotMake(f"no served UR: {said}")


def pack_through_ur(words, sequence, plant, perception):
    """A session in lockstep, the cell in a process of its own; with frames the camera, too."""
    with tempfile.TemporaryDirectory() as folder:
        boxes = f"ipc://{folder}/boxes"
        served, offset = serve_ur(words, sequence, plant, boxes)
        threading.Thread(target=served.stderr.read, daemon=True).start()
        camera = f"{words.snug} camera {SCENARIO} --click {boxes} --sequence {sequence} --seed {plant} --shot {{look}} -o {{frame}}.h5"
        frames = ["--frames", camera] if perception == "frames" else []
        try:
            return json.loads(run([words.snug, "pack", SCENARIO, "--sequence", sequence, "--plant-seed", plant, *UR_PACK, "--plant", f"ur://127.0.0.1:{offset}",
                                   "--observe", boxes, "--lockstep", "--perception", perception, *frames, "--json"]))
        finally:
            served.send_signal(signal.SIGINT)
            served.wait()


def ur_row(words, kept, how, sequence, plant):
    """How one session came out: made once for each commit."""
    key = f"{how} {sequence} {plant}"
    rows = json.loads(kept.read_text()) if kept.exists() else {}
    if key not in rows:
        inside = ["--perception", how.split()[1], "--set", "robot.velocity_fraction=0.5", "--json"]  # as a UR that follows
        result = (json.loads(run([words.snug, "pack", SCENARIO, "--sequence", sequence, "--plant-seed", plant, *UR_PACK, *inside])) if how.startswith("inside")
                  else pack_through_ur(words, sequence, plant, how.split()[1]))
        if result["failure"]:
            raise CannotMake(f"{key}: {result['failure']}")
        rows[key] = {name: result[name] for name in ("executed_percent", "executed_boxes", "items_sent", "items_as_planned", "boxes_lost")}
        kept.write_text(json.dumps(rows))
    return rows[key]


def ur_table(words, perceptions, plants, sequences):
    """`perceptions`: of the cell in one process, and through a UR."""
    kept = words.folder / f"ur-{commit()}.json"
    hows = (f"inside {perceptions[0]}", f"ur {perceptions[1]}")
    rows = {(how, name, plant): ur_row(words, kept, how, name, plant) for plant in plants for name in sequences for how in hows}
    lines = ["| % of the container | " + " | ".join(f"S{name}" for name in sequences) + " | mean |", "|---" * (len(sequences) + 2) + "|"]
    for plant in plants:
        for how, label in zip(hows, ("in one process", "through the UR")):
            cells = [rows[how, name, plant]["executed_percent"] for name in sequences]
            lines.append(f"| plant {plant}, {label} | " + " | ".join(f"{percent:.2f}" for percent in cells) + f" | {statistics.mean(cells):.2f} |")
    inside, through = ([row["executed_percent"] for key, row in rows.items() if key[0] == how] for how in hows)
    ur = [row for key, row in rows.items() if key[0] == hows[1]]
    sent, planned, lost = (sum(row[key] for row in ur) for key in ("items_sent", "items_as_planned", "boxes_lost"))
    inside_sent, inside_planned = (sum(row[key] for key_, row in rows.items() if key_[0] == hows[0]) for key in ("items_sent", "items_as_planned"))
    lines += ["", f"Through the UR {statistics.mean(through) - statistics.mean(inside):+.2f} points on average. Of {sent} boxes that were sent {planned} ended as planned "
              f"({100.0 * planned / sent:.1f} %; in one process {inside_planned} of {inside_sent}); {'none was' if lost == 0 else f'{lost} were'} lost.", "",
              origin(f"n = {len(ur)} sessions in lockstep, a served UR10, `{' '.join(UR_PACK)}`")]
    return "\n".join(lines)


def ur(words):
    """Sessions through a served UR beside those of the same plants in one process."""
    return {"ur": ur_table(words, ("exact", "exact"), UR_PLANTS, SEQUENCES)}


def ur_frames(words):
    """The same with a camera that is a program of its own and sees the robot, beside the simulated camera in one process, with the same errors."""
    return {"ur-frames": ur_table(words, ("camera", "frames"), (1, 2), SEQUENCES)}


MAKERS = {"ur": ur, "ur-frames": ur_frames}
