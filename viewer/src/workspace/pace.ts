// Pace: how the picture of a run that is watched follows the run.

/** s, in which what is shown comes two thirds nearer to the newest frame: a run is computed in bursts. */
const CATCH_UP = 0.6;

/** The time to show next: at least as fast as the run's clock, faster the farther it lags behind. */
export function nextTime(shown: number, end: number, passed: number): number {
  const lag = end - shown;
  return lag <= 0 ? end : Math.min(end, shown + Math.max(passed, lag * (1 - Math.exp(-passed / CATCH_UP))));
}
