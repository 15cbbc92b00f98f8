// The program for Python that reads bags.
#include "snug/archive_import/internal/readers.hpp"

namespace snug::archive_import::internal {

const char* const kBagProgram =
    R"PY("""Writes the messages of a bag that snug takes, one a line (JSON). Arguments: the bag, the file to write."""
import json
import math
import sys
from pathlib import Path


def leave(code, text):
    print(text, file=sys.stderr)
    sys.exit(code)


def part(of, *names):
    """A field of a message, whether that is an object or a dictionary; None where it is not there."""
    for name in names:
        if isinstance(of, dict):
            if name in of:
                return of[name]
        elif hasattr(of, name):
            return getattr(of, name)
    return None


def number(value):
    try:
        value = float(value)
    except (TypeError, ValueError):
        return None
    return value if math.isfinite(value) else None


def numbers(of, *names):
    return [number(part(of, name)) for name in names]


def nanoseconds(stamp, log_time):
    seconds, rest = part(stamp, "sec", "secs"), part(stamp, "nanosec", "nsec", "nsecs")
    if seconds is None:
        return log_time
    total = int(seconds) * 10**9 + int(rest or 0)
    return total if total > 0 else log_time


def rows_of(topic, kind, message, log_time):
    """What is written of a message: lists that begin with a word, the topic and the time in ns."""
    kind = kind.replace("/msg/", "/")
    header = part(message, "header")
    time = nanoseconds(part(header, "stamp"), log_time)
    frame = str(part(header, "frame_id") or "")
    if kind == "sensor_msgs/JointState":
        values = [[number(v) for v in (part(message, name) if part(message, name) is not None else [])] for name in ("position", "velocity", "effort")]
        yield ["joints", topic, time, [str(n) for n in part(message, "name")], *values]
    elif kind == "geometry_msgs/WrenchStamped":
        wrench = part(message, "wrench")
        yield ["wrench", topic, time, frame, numbers(part(wrench, "force"), "x", "y", "z") + numbers(part(wrench, "torque"), "x", "y", "z")]
    elif kind in ("geometry_msgs/PoseStamped", "geometry_msgs/PoseWithCovarianceStamped", "foxglove.PoseInFrame"):
        pose = part(message, "pose")
        if kind.endswith("CovarianceStamped"):
            pose = part(pose, "pose")
        if kind.startswith("foxglove"):
            time, frame = nanoseconds(part(message, "timestamp"), log_time), str(part(message, "frame_id") or "")
        yield ["pose", topic, time, frame, numbers(part(pose, "position"), "x", "y", "z") + numbers(part(pose, "orientation"), "x", "y", "z", "w")]
    elif kind in ("tf2_msgs/TFMessage", "tf/tfMessage", "foxglove.FrameTransforms", "geometry_msgs/TransformStamped", "foxglove.FrameTransform"):
        for one in [message] if kind in ("geometry_msgs/TransformStamped", "foxglove.FrameTransform") else part(message, "transforms") or []:
            if kind.startswith("foxglove"):
                time, parent, child = nanoseconds(part(one, "timestamp"), log_time), part(one, "parent_frame_id"), part(one, "child_frame_id")
                move, turn = part(one, "translation"), part(one, "rotation")
            else:
                head = part(one, "header")
                time, parent, child = nanoseconds(part(head, "stamp"), log_time), part(head, "frame_id"), part(one, "child_frame_id")
                move, turn = part(part(one, "transform"), "translation"), part(part(one, "transform"), "rotation")
            yield ["transform", topic, time, str(parent).lstrip("/"), str(child or topic).lstrip("/"), numbers(move, "x", "y", "z") + numbers(turn, "x", "y", "z", "w")]


WANTED = ("sensor_msgs/JointState", "geometry_msgs/WrenchStamped", "geometry_msgs/PoseStamped", "geometry_msgs/PoseWithCovarianceStamped",
          "geometry_msgs/TransformStamped", "tf2_msgs/TFMessage", "tf/tfMessage", "foxglove.PoseInFrame", "foxglove.FrameTransform",
          "foxglove.FrameTransforms")


def is_wanted(kind):
    return kind.replace("/msg/", "/") in WANTED


def of_mcap(path):
    try:
        from mcap.reader import make_reader
        from mcap.decoder import DecoderFactory
    except ImportError:
        leave(3, "mcap mcap-ros2-support mcap-ros1-support mcap-protobuf-support")
    factories = []
    for module in ("mcap_ros2.decoder", "mcap_ros1.decoder", "mcap_protobuf.decoder"):
        try:
            factories.append(__import__(module, fromlist=["DecoderFactory"]).DecoderFactory())
        except ImportError:
            pass

    class Json(DecoderFactory):
        def decoder_for(self, message_encoding, schema):
            return json.loads if message_encoding == "json" else None

    factories.append(Json())
    lacking = {"cdr": "mcap-ros2-support", "ros1": "mcap-ros1-support", "protobuf": "mcap-protobuf-support"}
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=factories)
        decoders = {}
        for schema, channel, message in reader.iter_messages():
            if schema is None or not is_wanted(schema.name):
                left[(channel.topic, schema.name if schema else "")] = True
                continue
            if channel.id not in decoders:
                found = [f.decoder_for(channel.message_encoding, schema) for f in factories]
                decoders[channel.id] = next((d for d in found if d), None)
                if decoders[channel.id] is None:
                    if channel.message_encoding in lacking:
                        leave(3, "mcap " + lacking[channel.message_encoding])
                    leave(2, f"topic {channel.topic}: messages in '{channel.message_encoding}', not CDR, ROS 1, protobuf or JSON")
            yield from rows_of(channel.topic, schema.name, decoders[channel.id](message.data), message.log_time)


said = []


def bag_of(path):
    """What is opened: of a folder whose only bag was renamed, or has no metadata.yaml, the bag itself; of a file whose folder describes it the
    folder, which has the types of its messages."""
    if path.is_dir():
        names = sorted(one.name for one in path.iterdir() if one.suffix in (".mcap", ".db3", ".bag"))
        if not names and not (path / "metadata.yaml").exists():
            leave(2, "there is no bag in the folder")
        if not names or any(describes(path, name) for name in names):
            return path
        if len(names) > 1:
            leave(2, "metadata.yaml names none of the files of the folder; give a bag itself: " + ", ".join(names[:3]))
        said.append("read from " + names[0] + ": the folder has no metadata.yaml that names it")
        return path / names[0]
    return path.parent if path.suffix == ".db3" and describes(path.parent, path.name) else path


def describes(folder, name):
    metadata = folder / "metadata.yaml"
    return metadata.exists() and name in metadata.read_text(encoding="utf-8", errors="replace")


def of_bag(path):
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        leave(3, "rosbags")
    with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
        wanted = [c for c in reader.connections if is_wanted(c.msgtype)]
        for connection in reader.connections:
            if connection not in wanted:
                left[(connection.topic, connection.msgtype)] = True
        if not wanted:
            return
        for connection, log_time, data in reader.messages(connections=wanted):
            yield from rows_of(connection.topic, connection.msgtype, reader.deserialize(data, connection.msgtype), log_time)


left = {}


def main():
    try:
        path = bag_of(Path(sys.argv[1]))
        with open(sys.argv[2], "w", encoding="utf-8", errors="replace") as out:
            for row in (of_mcap(path) if path.suffix.lower() == ".mcap" else of_bag(path)):
                out.write(json.dumps(row, ensure_ascii=True) + "\n")
            for text in said:
                out.write(json.dumps(["said", text, ""]) + "\n")
            for topic, kind in sorted(left):
                out.write(json.dumps(["left", topic, kind.replace("/msg/", "/")]) + "\n")
    except Exception as error:  # what readers raise for files that are broken is of many kinds
        leave(2, f"{type(error).__name__}: {error}")


main()
)PY";

}  // namespace snug::archive_import::internal
