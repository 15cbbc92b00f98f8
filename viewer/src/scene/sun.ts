// Where the sun stands; one place for the light of all parts of the drawing.

import { Vector3, type Box3, type DirectionalLight } from "three";

export const SUN = new Vector3(0.75, -1.1, 2.4).normalize();

/** Aims the sun between the robot and the container, with shadows over both. */
export function placeSun(sun: DirectionalLight, container: Box3 | null): void {
  const centre = container ? container.getCenter(new Vector3()).multiplyScalar(0.5) : new Vector3();
  sun.target.position.copy(centre);
  sun.position.copy(centre).addScaledVector(SUN, 3);
  const { camera } = sun.shadow;
  camera.left = camera.bottom = -1.3;
  camera.right = camera.top = 1.3;
  camera.near = 0.5;
  camera.far = 6;
  sun.shadow.mapSize.set(1024, 1024);
  sun.shadow.bias = -0.0008;
  sun.shadow.normalBias = 0.004;
}
