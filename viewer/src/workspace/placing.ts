// Placing: where a part of a cell goes by pointer and keys, in mm and degrees.

export interface Place {
  position: [number, number, number]; // mm
  yaw: number; // degrees
}

const TURN = 5; // degrees, by a key

/** To the nearest multiple of `step`; without noise in the last digits. */
export function snapped(value: number, step: number): number {
  const to = Math.round(value / step) * step;
  return Number(to.toFixed(6)) + 0; // no -0
}

/** Where a key moves a part: to the next multiple of `step` in its direction; null for other keys. */
export function moved(from: Place, key: string, step: number): Place | null {
  const axis = { ArrowRight: [0, 1], ArrowLeft: [0, -1], ArrowUp: [1, 1], ArrowDown: [1, -1], PageUp: [2, 1], PageDown: [2, -1] }[key];
  if (axis) {
    const [k, sign] = axis as [0 | 1 | 2, 1 | -1];
    const position: Place["position"] = [...from.position];
    const steps = position[k] / step;
    const next = sign > 0 ? Math.floor(steps + 1e-6) + 1 : Math.ceil(steps - 1e-6) - 1;
    position[k] = snapped(next * step, step);
    return { position, yaw: from.yaw };
  }
  if (key === "[" || key === "]") {
    const yaw = snapped(from.yaw + (key === "]" ? TURN : -TURN), TURN);
    return { position: [...from.position], yaw: yaw - 360 * Math.round(yaw / 360) };
  }
  return null;
}

/** Names in quotes: parts that a mistake is about. */
export const namesIn = (text: string): string[] => [...text.matchAll(/'([^']+)'/g)].map((found) => found[1]!);
