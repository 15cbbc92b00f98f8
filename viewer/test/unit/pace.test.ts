// How fine a processor draws: coarser while it cannot follow, fine again when it can; standing still says nothing.

import { describe, expect, it } from "vitest";
import { Pace } from "../../src/scene/pace";

const after = (pace: Pace, interval: number, pictures: number): number => {
  let ratio = 0;
  for (let i = 0; i < pictures; ++i) ratio = pace.ratioAfter(interval);
  return ratio;
};

describe("Pace", () => {
  it("draws coarser when pictures take long, and stays so until they are quick", () => {
    const pace = new Pace();
    expect(after(pace, 30, 50)).toBe(1);
    expect(after(pace, 80, 50)).toBeLessThan(1);
    expect(after(pace, 40, 50)).toBeLessThan(1); // between the two: as it was
    expect(after(pace, 17, 50)).toBe(1);
  });

  it("is not misled by one slow picture or by a drawing that stood still", () => {
    const pace = new Pace();
    after(pace, 30, 50);
    expect(after(pace, 150, 1)).toBe(1);
    expect(after(pace, 60_000, 20)).toBe(1);
  });
});
