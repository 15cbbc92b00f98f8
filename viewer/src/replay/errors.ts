// ReplayError: why a recording cannot be shown, in words for the person who opened it.

export class ReplayError extends Error {
  /** @param title what is wrong; @param detail what was found; @param hint what can be done about it */
  constructor(
    readonly title: string,
    readonly detail: string,
    readonly hint = "",
  ) {
    super(`${title}: ${detail}`);
    this.name = "ReplayError";
  }
}
