// Lit: the look of what moves. Without shadows its light is computed at the corners only, which a computer without a graphics
// card draws in half the time (and flat faces look the same); with shadows at each pixel.

import {
  Color, MeshBasicMaterial, MeshLambertMaterial, type Material, type Mesh, type MeshBasicMaterialParameters,
  type Vector3, type WebGLProgramParametersWithUniforms,
} from "three";
import type { Palette } from "./palette";
import { SUN } from "./sun";

type Extend = (shader: WebGLProgramParametersWithUniforms) => void;

/** Light of the one drawing that a page has; as three's hemisphere and directional light over a Lambert surface. */
const light = {
  litSky: { value: new Color() },
  litGround: { value: new Color() },
  litSun: { value: 1 },
  litToSun: { value: SUN.clone() },
};

export function setLight(palette: Palette): void {
  light.litSky.value.set(palette.skyLight).multiplyScalar(palette.ambient / Math.PI);
  light.litGround.value.set(palette.groundLight).multiplyScalar(palette.ambient / Math.PI);
  light.litSun.value = palette.sun / Math.PI;
}

/** Unit vector to the sun, W. */
export function aimLight(toSun: Vector3): void {
  light.litToSun.value.copy(toSun);
}

const VERTEX_HEAD = `
uniform vec3 litSky;
uniform vec3 litGround;
uniform float litSun;
uniform vec3 litToSun;
varying vec3 vLit;
`;
const VERTEX_BODY = `
vec3 litNormal = normal;
#ifdef USE_INSTANCING
mat3 litTurn = mat3(instanceMatrix);
litNormal = litTurn * (litNormal / vec3(dot(litTurn[0], litTurn[0]), dot(litTurn[1], litTurn[1]), dot(litTurn[2], litTurn[2])));
#endif
litNormal = normalize(mat3(modelMatrix) * litNormal);
vLit = mix(litGround, litSky, 0.5 + 0.5 * litNormal.z) + vec3(litSun * max(0.0, dot(litNormal, litToSun)));
`;

function lightAtCorners(shader: WebGLProgramParametersWithUniforms): void {
  Object.assign(shader.uniforms, light);
  shader.vertexShader = VERTEX_HEAD + shader.vertexShader.replace("#include <begin_vertex>", `#include <begin_vertex>\n${VERTEX_BODY}`);
  shader.fragmentShader =
    "varying vec3 vLit;\n" + shader.fragmentShader.replace("#include <opaque_fragment>", "outgoingLight *= vLit;\n#include <opaque_fragment>");
}

export class Lit {
  private readonly plain_: MeshBasicMaterial;
  private readonly full_: MeshLambertMaterial;

  /** `name` and `extend`: a shader that differs from the usual one. */
  constructor(parameters: MeshBasicMaterialParameters, name = "", extend: Extend = () => {}) {
    this.plain_ = new MeshBasicMaterial({ fog: false, ...parameters });
    this.full_ = new MeshLambertMaterial({ fog: false, ...parameters });
    this.plain_.onBeforeCompile = (shader) => {
      extend(shader);
      lightAtCorners(shader);
    };
    this.full_.onBeforeCompile = extend;
    this.plain_.customProgramCacheKey = () => `lit at corners ${name}`;
    this.full_.customProgramCacheKey = () => `lit ${name}`;
  }

  setColour(colour: string): void {
    this.plain_.color.set(colour);
    this.full_.color.set(colour);
  }

  change(change: (material: Material) => void): void {
    for (const material of [this.plain_, this.full_]) {
      change(material);
      material.needsUpdate = true;
    }
  }

  of(hasShadows: boolean): Material {
    return hasShadows ? this.full_ : this.plain_;
  }
}

/** A mesh that changes its look with the shadows. */
export interface LitMesh {
  mesh: Mesh;
  look: Lit;
}

export function useShadows(meshes: LitMesh[], on: boolean): void {
  for (const { mesh, look } of meshes) mesh.material = look.of(on);
}
