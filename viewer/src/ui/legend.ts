// Legend: what the colours of the contacts mean and how long an arrow is, in the corner of the drawing.

import type { View } from "../scene/view";
import { make } from "./dom";

const ROUND = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];
/** Length that the bar for the arrows should have, pixels. */
const BAR = 70;

export class Legend {
  readonly element = make("div", "legend-box");
  private readonly bar_ = make("i", "bar-of-force");
  private readonly barText_ = make("span");
  private readonly count_ = make("small");
  private readonly forces_ = make("div", "force-scale", this.bar_, this.barText_);
  private readonly trace_ = make("div", "item");
  private readonly place_ = make("div", "item");
  private readonly states_ = make("div", "states");
  private readonly rest_ = make("div", "item", make("i", "dot pale"), "at rest");
  private readonly measure_ = make("div", "item measured");
  private text_ = "";

  constructor(private readonly view: View) {
    this.rest_.title = "Contacts of boxes that sleep, as they were recorded last";
    this.element.append(this.measure_, this.states_, this.forces_, this.count_, this.place_, this.trace_);
    this.setPalette();
    view.onAfterRender = () => this.update();
  }

  setPalette(): void {
    const p = this.view.palette;
    const item = (colour: string, text: string, shape = "dot"): HTMLElement => {
      const mark = make("i", shape);
      mark.style.background = colour;
      return make("div", "item", mark, text);
    };
    const hasState = this.view.replay.contacts?.state !== undefined;
    this.states_.replaceChildren(
      ...(hasState
        ? [item(p.sticking, "sticking"), item(p.sliding, "sliding"), item(p.open, "separating"), this.rest_]
        : [item(p.unknown, "contact")]),
    );
    const dashed = make("i", "dashes");
    dashed.style.borderColor = p.select;
    this.place_.replaceChildren(dashed, make("span"));
    const line = make("i", "line");
    line.style.background = p.trace;
    this.trace_.replaceChildren(line, make("span"));
    this.bar_.style.background = p.sticking;
    this.text_ = "";
  }

  /** After each picture: only what has changed is written, so that playing costs nothing here. */
  private update(): void {
    const { view } = this;
    const { options } = view;
    const hasContacts = view.replay.contacts !== null && (options.contacts || options.forces);
    const hasForces = (view.replay.contacts !== null && options.forces) || options.wrenches;
    const newtonsOfBar = (BAR * view.pixelAtTarget) / view.arrowScale;
    const newtons = ROUND.reduce((best, n) => (Math.abs(Math.log(n / newtonsOfBar)) < Math.abs(Math.log(best / newtonsOfBar)) ? n : best));
    const width = (newtons * view.arrowScale) / view.pixelAtTarget;
    const { awake, resting } = view.contactsDrawn;
    const offset = options.ghost ? view.offsetText() : "";
    const trace = options.trace && view.tracePoint ? (view.tracePoint.kind === "tool" ? "trace of E" : `trace of ${view.tracePoint.label}`) : "";
    const measured = view.measure.text();
    const text = [hasContacts, hasForces, newtons, width.toFixed(0), awake, resting, offset, trace, measured].join();
    if (text === this.text_) return;
    this.text_ = text;
    this.measure_.hidden = measured === "";
    this.measure_.textContent = measured;
    this.rest_.hidden = resting === 0;
    this.states_.hidden = !hasContacts;
    this.forces_.hidden = !hasForces;
    this.bar_.style.width = `${width.toFixed(0)}px`;
    this.barText_.textContent = `${newtons} N`;
    this.count_.hidden = !hasContacts;
    this.count_.textContent = `${awake} contact points${resting ? `, ${resting} at rest` : ""}`;
    this.place_.hidden = offset === "";
    this.place_.lastElementChild!.textContent = offset;
    this.place_.title = options.ghost ? view.offsetText(true) : "";
    this.trace_.hidden = trace === "";
    this.trace_.lastElementChild!.textContent = trace;
  }
}
