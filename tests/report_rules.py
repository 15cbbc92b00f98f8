"""report_rules.py: the demonstrator's rules for comparing a simulated run with its experiment, written from their description in the report and in its analysis
(moving medians, gaps filled by pchip, Savitzky-Golay over 50 samples, nearest samples, differences of rotation vectors, limits of 150 mm and 15 degrees), not
from the program that it checks. numpy only.

Input: tables as `snug export --format csv` (the simulation) and `snug archive convert` (the experiment) write them: names and conventions of mc_rtc, so that
orientations are those of the world in the body, and a wrench has its couple first."""
import csv

import numpy as np

PERIOD = 1.0 / 125.0  # s, of the demonstrator's controller
POSITION_LIMIT, ROTATION_LIMIT = 0.15, np.deg2rad(15.0)
POSITION_MEDIAN, ROTATION_MEDIAN = 3.0, 10.0  # s
SMOOTHED_OVER = 50  # samples


def read_table(path):
    with open(path, newline="", encoding="utf-8") as file:
        rows = csv.reader(file, delimiter=";")
        names = next(rows)
        columns = list(zip(*rows))
    return {name: np.array([float(cell) if cell else np.nan for cell in column]) for name, column in zip(names, columns)
            if name == "t" or "_FloatingBase_" in name or name.startswith("UR10FTSensor_")}


def rotation_of(quat):
    w, x, y, z = quat / np.linalg.norm(quat)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def log_of(R):
    """The rotation vector, of an angle up to pi."""
    cosine = np.clip((np.trace(R) - 1.0) / 2.0, -1.0, 1.0)
    angle = np.arccos(cosine)
    axis = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    if angle < 1e-8:
        return axis / 2.0
    if np.pi - angle < 1e-4:  # the axis is that of the largest column of R + 1
        column = (R + np.eye(3))[:, np.argmax(np.diag(R))]
        column = column / np.linalg.norm(column)
        return angle * (column if column @ axis >= 0.0 else -column)
    return angle * axis / (2.0 * np.sin(angle))


def poses_of(table, body):
    """Rotations in the world and positions, not a number where there are none."""
    q = np.stack([table[f"{body}_FloatingBase_orientation_{axis}"] for axis in "wxyz"], axis=1)
    p = np.stack([table[f"{body}_FloatingBase_position_{axis}"] for axis in "xyz"], axis=1)
    R = np.full((len(p), 3, 3), np.nan)
    for k in np.flatnonzero(np.isfinite(q).all(axis=1)):
        R[k] = rotation_of(q[k]).T  # the log has the inverse
    return R, p


def without_jumps(vectors):
    """Rotation vectors one after the other, without the jump at pi: the same rotation's vector that is nearest to the one before."""
    result, last = vectors.copy(), np.zeros(3)
    for k, w in enumerate(vectors):
        if not np.isfinite(w).all():
            continue
        angle = np.linalg.norm(w)
        if angle > 1e-9:
            choices = [w, w * (1 - 2 * np.pi / angle), w * (1 + 2 * np.pi / angle)]
            w = min(choices, key=lambda one: np.linalg.norm(one - last))
        result[k] = last = w
    return result


def without_outliers(times, values, window):
    """Three scaled median deviations from a moving median, each of `window` seconds around the sample: not a number."""
    result = values.copy()
    first = np.searchsorted(times, times - window / 2, side="left")
    end = np.searchsorted(times, times + window / 2, side="right")
    for k in range(len(values)):
        near = values[first[k]:end[k]]
        near = near[np.isfinite(near)]
        if not len(near):
            continue
        middle = np.median(near)
        if abs(values[k] - middle) > 3.0 * 1.4826 * np.median(np.abs(near - middle)):
            result[k] = np.nan
    return result


def filled(times, values):
    """Gaps between known samples by Fritsch and Carlson's shape-preserving cubics (pchip)."""
    known = np.flatnonzero(np.isfinite(values))
    if len(known) < 2:
        return values
    t, y = times[known], values[known]
    h, d = np.diff(t), np.diff(y) / np.diff(t)
    m = np.zeros(len(t))
    for k in range(1, len(t) - 1):
        if d[k - 1] * d[k] > 0.0:
            a, b = 2 * h[k] + h[k - 1], h[k] + 2 * h[k - 1]
            m[k] = (a + b) / (a / d[k - 1] + b / d[k])
    m[0], m[-1] = d[0], d[-1]
    result = values.copy()
    for k in range(len(t) - 1):
        gap = np.arange(known[k] + 1, known[k + 1])
        s = (times[gap] - t[k]) / h[k]
        result[gap] = ((1 + 2 * s) * (1 - s) ** 2 * y[k] + s * (1 - s) ** 2 * h[k] * m[k] + s * s * (3 - 2 * s) * y[k + 1] - s * s * (1 - s) * h[k] * m[k + 1])
    return result


def smoothed(values):
    """A parabola through 50 samples, 25 before and 24 after, and through what there is of them at the ends, at the sample itself."""
    half = SMOOTHED_OVER // 2
    padded = np.r_[np.full(half, np.nan), values, np.full(half - 1, np.nan)]
    windows = np.lib.stride_tricks.sliding_window_view(padded, SMOOTHED_OVER)
    at_zero = np.linalg.pinv(np.vander(np.arange(-half, half), 3))[2]
    result = windows @ at_zero  # not a number where a sample is missing
    for k in np.flatnonzero(~np.isfinite(result) & np.isfinite(values)):
        near = np.flatnonzero(np.isfinite(windows[k]))
        result[k] = np.polynomial.polynomial.polyfit(near - half, windows[k][near], 2)[0] if len(near) > 2 else values[k]
    return np.where(np.isfinite(values), result, np.nan)


def nearest(times, at):
    """Index of the nearest time, and whether it is within half a period of the controller."""
    after = np.clip(np.searchsorted(times, at), 1, len(times) - 1)
    index = np.where(at - times[after - 1] < times[after] - at, after - 1, after)
    return index, np.abs(times[index] - at) <= PERIOD / 2


def rms(values):
    values = values[np.isfinite(values)]
    return np.sqrt(np.mean(values**2)) if len(values) else np.nan


def compare(simulation, mocap, wrench, simulated_body, measured_body, start, end, shifts=(0.0, 0.0), bias=np.zeros(6)):
    """Errors of one box in its window [s]: rest and RMS of position [m] and rotation [rad], RMS of force [N] and torque [Nm]. `shifts`: what the clocks of
    motion capture and of the force/torque sensor show at time 0 of the simulation; `bias`: couple and force that the sensor reads too much."""
    inside = (simulation["t"] >= start) & (simulation["t"] <= end)
    t = simulation["t"][inside]
    # Motion capture in the base of the robot, by the mean of its pose.
    R_base, p_base = poses_of(mocap, "Base005")
    u, _, v = np.linalg.svd(np.nanmean(R_base, axis=0))
    R_b, p_b = u @ v, np.nanmean(p_base, axis=0)
    times = mocap["t"] - shifts[0]
    seen = (times >= start) & (times <= end)
    R, p = poses_of({name: values[seen] for name, values in mocap.items()}, measured_body)
    tm = times[seen]
    log = np.full_like(p, np.nan)
    for k in np.flatnonzero(np.isfinite(p).all(axis=1)):
        log[k] = log_of(R_b.T @ R[k])
    columns = np.hstack([(p - p_b) @ R_b, without_jumps(log)])
    held = np.r_[False, (np.diff(columns, axis=0) == 0.0).all(axis=1)]
    for k in range(6):
        column = without_outliers(tm, columns[:, k], POSITION_MEDIAN if k < 3 else ROTATION_MEDIAN)
        column[held] = np.nan
        columns[:, k] = smoothed(filled(tm, column))
    R_s, p_s = poses_of({name: values[inside] for name, values in simulation.items()}, simulated_body)
    w_s = without_jumps(np.array([log_of(one) if np.isfinite(one).all() else np.full(3, np.nan) for one in R_s]))
    index, is_near = nearest(tm, t)
    w = columns[index, 3:]
    angle = np.linalg.norm(w, axis=1, keepdims=True)
    for turn in (-2 * np.pi, 2 * np.pi):  # the jump at pi
        other = np.where(angle > 1e-9, w * (1 + turn / np.maximum(angle, 1e-9)), w)
        jumps = np.linalg.norm(w - w_s, axis=1) > np.pi
        nearer = np.linalg.norm(other - w_s, axis=1) < np.linalg.norm(w - w_s, axis=1)
        w = np.where((jumps & nearer)[:, None], other, w)
    e_p = np.where(is_near, np.linalg.norm(columns[index, :3] - p_s, axis=1), np.nan)
    e_r = np.where(is_near, np.linalg.norm(w - w_s, axis=1), np.nan)
    both = np.isfinite(e_p) & np.isfinite(e_r)
    last = np.flatnonzero(both)[-1]
    found = {"rest_position": e_p[last], "rest_rotation": e_r[last], "rms_position": rms(np.where(both & (e_p <= POSITION_LIMIT), e_p, np.nan)),
             "rms_rotation": rms(np.where(both & (e_r <= ROTATION_LIMIT), e_r, np.nan))}
    # The sensor's samples nearest to the simulation's instants, smoothed there, less the simulation.
    names = [f"UR10FTSensor_{axis}" for axis in ("cx", "cy", "cz", "fx", "fy", "fz")]
    index, is_near = nearest(wrench["t"] - shifts[1], simulation["t"])
    first, count = np.flatnonzero(inside)[0], len(t)
    around = slice(max(0, first - SMOOTHED_OVER), first + count + SMOOTHED_OVER)
    error = np.empty((count, 6))
    for k, name in enumerate(names):
        measured = np.where(is_near, wrench[name][index] - bias[k], np.nan)
        error[:, k] = smoothed(measured[around])[first - around.start:][:count] - simulation[name][inside]
    found["rms_torque"] = rms(np.linalg.norm(error[:, :3], axis=1))
    found["rms_force"] = rms(np.linalg.norm(error[:, 3:], axis=1))
    return found
