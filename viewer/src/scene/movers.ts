// Movers: bodies that move and are no plain boxes (the tool, links of a robot, plungers, hulls), one mesh each.

import { Color, Float32BufferAttribute, Group, Matrix4, Mesh, SRGBColorSpace, type Material } from "three";
import type { Look, Shape } from "../replay/header";
import type { Replay } from "../replay/replay";
import { Lit, useShadows } from "./lit";
import { matrixOf } from "./maths";
import type { BoxColours, Palette } from "./palette";
import { mergeGeometries, shapeGeometry } from "./shapes";

/** Shapes of the tool without those that only stand in for the cup: the cup is drawn as it is deformed. */
export function toolShapes(shapes: Shape[], hasCup: boolean): Shape[] {
  return hasCup ? shapes.filter((s) => s.pose[2] <= 0) : shapes;
}

export function meshOfShapes(shapes: Shape[], material: Material): Mesh | null {
  if (shapes.length === 0) return null;
  return new Mesh(mergeGeometries(shapes.map((s) => shapeGeometry(s).faces)), material);
}

export class Movers {
  readonly group = new Group();
  /** Links of a robot, shown and hidden together. */
  readonly links = new Group();
  private readonly linkLook_: Lit;
  private readonly colouredLook_: Lit;
  private readonly items_: { body: number; mesh: Mesh; look: Lit; role: "tool" | "link" | "body" }[] = [];
  private readonly pose_ = new Float64Array(7);

  constructor(replay: Replay, palette: Palette, colours: BoxColours, boxes: number[]) {
    const toolBody = replay.header.tool?.body ?? -1;
    const hasCup = replay.header.cup !== null;
    const links = new Set(replay.header.robot?.links ?? []);
    this.linkLook_ = new Lit({ color: palette.link });
    this.colouredLook_ = new Lit({ vertexColors: true });
    const looks = new Map((replay.header.robot?.looks ?? []).map((look) => [look.body, look]));
    this.group.add(this.links);
    replay.bodies.forEach((body, k) => {
      const role = k === toolBody ? "tool" : links.has(k) ? "link" : "body";
      if ((body.kind === "static" && role === "body") || boxes.includes(k)) return;
      const own = role === "link" ? looks.get(k) : undefined;
      if (own) return this.addLook(k, own);
      const look = role === "link" ? this.linkLook_ : new Lit({ color: role === "tool" ? palette.tool : colours.of(body.type || body.name) });
      const mesh = meshOfShapes(role === "tool" ? toolShapes(body.shapes, hasCup) : body.shapes, look.of(false));
      if (!mesh) return;
      mesh.matrixAutoUpdate = false;
      mesh.castShadow = true;
      this.items_.push({ body: k, mesh, look, role });
      (role === "link" ? this.links : this.group).add(mesh);
    });
    if (toolBody < 0 && replay.header.tool) {
      const look = new Lit({ color: palette.tool });
      const mesh = meshOfShapes(toolShapes(replay.header.tool.shapes, hasCup), look.of(false));
      if (mesh) {
        mesh.matrixAutoUpdate = false;
        this.items_.push({ body: -1, mesh, look, role: "tool" });
        this.group.add(mesh);
      }
    }
  }

  /** A link as its description says that it looks, in one mesh with the colours of its parts. */
  private addLook(body: number, look: Look): void {
    const geometry = mergeGeometries(
      look.parts.map(({ shape, colour }) => {
        const { faces } = shapeGeometry(shape);
        const part = faces.index ? faces.toNonIndexed() : faces;
        const shade = new Color().setRGB(...colour, SRGBColorSpace);
        const shades = Array.from({ length: part.getAttribute("position").count }, () => [shade.r, shade.g, shade.b]);
        part.setAttribute("color", new Float32BufferAttribute(shades.flat(), 3));
        return part;
      }),
    );
    const mesh = new Mesh(geometry, this.colouredLook_.of(false));
    mesh.matrixAutoUpdate = false;
    mesh.castShadow = true;
    this.items_.push({ body, mesh, look: this.colouredLook_, role: "link" });
    this.links.add(mesh);
  }

  setPalette(palette: Palette): void {
    for (const { role, look } of this.items_) if (role !== "body" && look !== this.colouredLook_) look.setColour(role === "tool" ? palette.tool : palette.link);
  }

  /** From above and the side an arm would hide the container. */
  setLinksTranslucent(on: boolean): void {
    for (const look of [this.linkLook_, this.colouredLook_]) {
      look.change((material) => {
        material.transparent = on;
        material.opacity = on ? 0.3 : 1;
        material.depthWrite = !on;
      });
    }
  }

  setShadows(on: boolean): void {
    useShadows(this.items_, on);
  }

  update(replay: Replay, frame: number): void {
    for (const item of this.items_) {
      const isThere =
        item.body >= 0
          ? replay.bodyPose(item.body, frame, this.pose_)
          : replay.pose(replay.channel("tool.pose"), frame, this.pose_);
      item.mesh.visible = isThere;
      if (isThere) matrixOf(this.pose_, item.mesh.matrix);
      item.mesh.matrixWorldNeedsUpdate = true;
    }
  }

  /** World matrix of a body as drawn, or null. */
  drawnMatrix(body: number): Matrix4 | null {
    const item = this.items_.find((x) => x.body === body);
    if (!item || !item.mesh.visible || !item.mesh.parent?.visible) return null;
    item.mesh.updateWorldMatrix(true, false);
    return item.mesh.matrixWorld.clone();
  }
}
