// Pace: how fine a processor draws: coarser while it cannot follow, fine when all stands still.

/** Above SLOW_MS between pictures there are COARSE samples a pixel's edge until it takes less than FAST_MS. */
const SLOW_MS = 55;
const FAST_MS = 22;
const COARSE = 0.7;
/** Longer than that between two pictures: nothing moved. */
const STOOD_MS = 300;

export class Pace {
  private mean_ = 40;
  private ratio_ = 1;

  /** Samples a pixel's edge for the next picture while things move; `interval`: since the last picture, ms. */
  ratioAfter(interval: number): number {
    if (interval < STOOD_MS) this.mean_ += 0.1 * (interval - this.mean_);
    if (this.mean_ > SLOW_MS) this.ratio_ = COARSE;
    else if (this.mean_ < FAST_MS) this.ratio_ = 1;
    return this.ratio_;
  }
}

/** Whether a processor draws instead of a graphics card. */
export function isSoftwareRenderer(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return true;
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}
