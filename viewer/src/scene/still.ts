// Still: a scene drawn once from another camera onto another canvas, without fog and with the light from where one looks.

import { Vector3, type Camera, type DirectionalLight, type Object3D, type Scene, type WebGLRenderer } from "three";
import { aimLight } from "./lit";
import { SUN } from "./sun";

export interface Studio {
  renderer: WebGLRenderer;
  scene: Scene;
  sun: DirectionalLight;
  hidden: Object3D[]; // that are not in the picture
}

/** Leaves the scene as it was; size and pixel ratio of the renderer are the caller's to set again. */
export function drawStill({ renderer, scene, sun, hidden }: Studio, camera: Camera, target: HTMLCanvasElement): void {
  const shown = hidden.map((o) => o.visible);
  hidden.forEach((o) => (o.visible = false));
  renderer.setPixelRatio(1);
  renderer.setSize(2 * target.width, 2 * target.height, false);
  const fog = scene.fog;
  scene.fog = null;
  // Light from where one looks: the sides that are seen are not in the dark.
  const toSun = camera.getWorldDirection(new Vector3()).negate().setZ(0.5).normalize();
  sun.position.copy(sun.target.position).addScaledVector(toSun, 3);
  aimLight(toSun);
  renderer.render(scene, camera);
  sun.position.copy(sun.target.position).addScaledVector(SUN, 3);
  aimLight(SUN);
  const pen = target.getContext("2d")!;
  pen.imageSmoothingQuality = "high";
  pen.drawImage(renderer.domElement, 0, 0, target.width, target.height);
  scene.fog = fog;
  hidden.forEach((o, i) => (o.visible = shown[i]!));
}
