// Where the sun stands; one place for the light of all parts of the drawing.

import { Vector3 } from "three";

export const SUN = new Vector3(0.75, -1.1, 2.4).normalize();
