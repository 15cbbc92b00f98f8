// Plan stage: the cell in 3D with the boxes where they are perceived, and the box at hand where it is planned: of a cell that
// another program serves, whose own recording is elsewhere.

import { decodeBase64, decodeReplay } from "../replay/decode";
import { Replay } from "../replay/replay";
import { api, type CellPart, type Decisions } from "./api";
import { make } from "./dom";
import { Stage, type DrawnBox } from "./stage";

/** A place in the container's frame, in W; the container turns about the vertical only. */
export function inWorld(container: CellPart, position: [number, number, number]): [number, number, number] {
  const yaw = (container.yaw_deg * Math.PI) / 180;
  const [x, y, z] = position;
  const [ox, oy, oz] = container.position_mm;
  return [ox + Math.cos(yaw) * x - Math.sin(yaw) * y, oy + Math.sin(yaw) * x + Math.cos(yaw) * y, oz + z];
}

/** Boxes as they are perceived, then the one that is planned and not packed yet. */
export function boxesInWorld(found: Decisions, which: number, container: CellPart): DrawnBox[] {
  const boxes: DrawnBox[] = found.standing.map((box) => ({ centre: box.position_mm, extent: box.extent_mm, yaw_deg: 0, isPlanned: false }));
  const one = found.decisions[which];
  if (one?.planned && one.extent_mm) boxes.push({ centre: inWorld(container, one.planned.position_mm), extent: one.extent_mm, yaw_deg: container.yaw_deg, isPlanned: true });
  return boxes;
}

export class PlanStage {
  readonly element = make("div", "plan-stage");
  private stage_: Stage | null = null;
  private of_ = "";
  private container_: CellPart | null = null;

  constructor() {
    this.element.hidden = true;
  }

  /** Draws the cell once, its boxes each time. */
  async show(scenario: string, found: Decisions, which: number): Promise<void> {
    if (scenario !== this.of_) {
      this.of_ = scenario;
      this.container_ = null;
      const { text, facts } = await api.facts(scenario);
      const scene = await api.scene(scenario, text);
      const replay = new Replay(await decodeReplay(decodeBase64(scene.form)));
      if (scenario !== this.of_) return;
      this.container_ = scene.parts.find(({ key }) => key === `containers.${facts?.target}`) ?? null;
      this.stage_ ??= new Stage("The cell in 3D with its boxes where they are perceived, and the one at hand where it is planned");
      this.element.replaceChildren(this.stage_.element, make("p", "hint", "Solid: as perceived. Lines: the box at hand, as planned."));
      this.element.hidden = false;
      this.stage_.show(replay, [], true);
    }
    if (this.container_) this.stage_?.showBoxes(boxesInWorld(found, which, this.container_));
  }

  hide(): void {
    this.element.hidden = true;
    this.of_ = "";
  }
}
