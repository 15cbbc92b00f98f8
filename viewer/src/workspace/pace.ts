// Pace: how the picture of a run that is watched follows the run, which is computed in bursts: seconds of motion at once, then
// nothing while the next box is planned.

/** s, in which what is shown comes two thirds nearer to the newest frame while that is far: a burst lasts until the next one comes. */
const CATCH_UP = 3;
/** s of the plant's time, two messages: nearer to the newest frame the picture goes more slowly, so that it seldom waits for it. */
const NEAR = 1;
/** s; so near to the newest frame it is shown. */
const THERE = 0.004;

/** The time to show next: as fast as the run's clock, faster the farther it lags behind, more slowly just behind a run that goes on. */
export function nextTime(shown: number, end: number, passed: number, goesOn = true): number {
  const lag = end - shown;
  if (lag <= THERE) return end;
  const speed = lag > NEAR ? Math.max(1, lag / CATCH_UP) : goesOn ? lag / NEAR : 1;
  return Math.min(end, shown + speed * passed);
}

/** Without a graphics card each picture is taken from the run: 40 a second then, evenly. */
export class Throttle {
  private next_ = 0;
  constructor(private readonly most_: number) {}

  /** Whether a picture may be drawn at this time, ms. */
  may(now: number): boolean {
    if (now < this.next_ - 1) return false;
    const step = 1000 / this.most_;
    this.next_ = Math.max(this.next_ + step, now);
    return true;
  }
}
