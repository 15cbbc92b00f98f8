// App: puts the parts of the page together and gives them keys.

import type { Replay } from "../replay/replay";
import type { CameraName } from "../scene/cameras";
import type { Theme } from "../scene/palette";
import { SECTION_AXES, type SectionAxis } from "../scene/section";
import { CAMERA_NAMES, View, type ViewOption } from "../scene/view";
import { About } from "./about";
import { button, make } from "./dom";
import { helpOverlay } from "./help";
import { ItemEvents } from "./events";
import { Legend } from "./legend";
import { Player } from "./player";
import { Plots } from "./plots";
import { sessionPanel } from "./session";
import { endPanel, headline, warningLine } from "./summary";
import { Timeline } from "./timeline";

const OPTION_TEXTS: Record<ViewOption, string> = {
  names: "names", contacts: "contact points", forces: "contact forces", wrenches: "cup and flange force", ghost: "commanded and planned pose",
  frames: "frames", trace: "trace", xray: "see-through boxes", robot: "robot", walls: "container walls", second: "second recording",
  shadows: "shadows",
};

export class App {
  readonly element = make("div", "app");
  readonly player: Player;
  readonly view: View;
  readonly plots: Plots;
  readonly itemEvents: ItemEvents;
  private readonly timeline_: Timeline;
  private readonly help_: HTMLElement;
  private readonly about_: About;
  private readonly legend_: Legend;
  private readonly cameraButtons_ = new Map<CameraName, HTMLButtonElement>();
  private readonly optionBoxes_ = new Map<ViewOption, HTMLInputElement>();
  private readonly stage_ = make("div", "drawing");
  private readonly sectionBoxes_ = new Map<SectionAxis, HTMLButtonElement>();
  private readonly measureButton_: HTMLButtonElement;
  private isMeasuring_ = false;
  private readonly gone_ = new AbortController();
  private readonly end_: HTMLElement | null;
  private readonly resizes_: ResizeObserver;

  constructor(
    readonly replay: Replay,
    second: Replay | null,
    private theme_: Theme,
    isPicture: boolean,
  ) {
    document.documentElement.dataset.theme = theme_;
    this.player = new Player(replay);
    this.view = new View(replay, second, theme_, isPicture);
    this.view.colours.learn(replay.bodies.map((body) => body.type).filter((type) => type !== ""));
    this.plots = new Plots(replay, second, this.player, theme_);
    this.itemEvents = new ItemEvents(replay, this.player, this.view);
    this.timeline_ = new Timeline(this.player, replay);
    this.help_ = helpOverlay(() => this.view.palette);
    this.about_ = new About(second ? [replay, second] : [replay], this.view, this.player);
    this.legend_ = new Legend(this.view);
    this.end_ = endPanel(replay, second, this.view, () => this.about_.show("container"));
    const session = sessionPanel(replay);
    const side = make("div", "side", ...(session ? [session] : []), this.itemEvents.element, ...(this.end_ ? [this.end_] : []));
    this.itemEvents.onSelect = (box) => this.plots.setBox(box);
    this.plots.onWide = (isWide) => this.element.classList.toggle("wide", isWide);
    this.measureButton_ = button("measure", "Distance between two points: click them (m)", () => this.setMeasuring(!this.isMeasuring_));
    this.stage_.append(this.view.element);
    const stage = make("main", "stage", this.toolbar(), this.stage_, this.legend_.element);
    const warnings = warningLine(replay, () => this.about_.show("run"));
    this.element.append(this.header(), ...(warnings ? [warnings] : []), side, stage, this.plots.element, this.timeline_.element, this.about_.element, this.help_);
    this.player.onChange(() => this.view.setFrame(this.player.frame));
    this.resizes_ = new ResizeObserver(() => this.fit());
    this.resizes_.observe(this.stage_);
    this.listen();
  }

  /** After the element is in the document: the drawing first, plots and the picture of the end when it stands. */
  start(): void {
    this.fit();
    this.useCamera("cell");
    this.player.setTime(this.replay.start);
    setTimeout(() => {
      this.plots.start();
      this.drawEnd();
    }, 50);
  }

  /** At the time, and with the camera and the box, at which another showed the same run. */
  goOnFrom(other: App): void {
    this.useCamera(other.view.cameras.name);
    this.player.setTime(other.player.time);
    this.itemEvents.select(other.itemEvents.selected);
  }

  /** After a live run has grown: what is drawn from all of it. */
  refresh(): void {
    this.element.querySelector(".headline")!.replaceWith(headline(this.replay));
    this.itemEvents.refresh();
    this.timeline_.refresh();
    this.plots.refresh();
    this.drawEnd();
  }

  /** Something more to press, beside the cameras. */
  addTool(element: HTMLElement): void {
    this.element.querySelector(".toolbar")!.append(element);
  }

  /** Before another takes its place. */
  dispose(): void {
    this.player.pause();
    this.gone_.abort();
    this.resizes_.disconnect();
    this.view.dispose();
  }

  private drawEnd(): void {
    this.end_?.dispatchEvent(new Event("snug:draw"));
  }

  private fit(): void {
    this.view.resize(this.stage_.clientWidth, this.stage_.clientHeight);
  }

  private header(): HTMLElement {
    const bar = make("header", "bar", headline(this.replay));
    bar.append(
      button("plots", "Plots, wide (w)", () => this.plots.setWide(!this.plots.isWide), "for-plots"),
      button("about", "What ran: settings, program, scenario, boxes (i)", () => this.about_.toggle()),
      button("◐", "Light or dark (d)", () => this.setTheme(this.theme_ === "light" ? "dark" : "light")),
      button("?", "Keys and colours (?)", () => this.showHelp()),
    );
    return bar;
  }

  /** Where nothing is a tool there is nothing to look along. */
  private get cameraNames(): readonly CameraName[] {
    return CAMERA_NAMES.filter((name) => name !== "tool" || this.replay.hasTool);
  }

  private toolbar(): HTMLElement {
    const cameras = make("div", "cameras");
    for (const name of this.cameraNames) {
      const choose = button(name, `Camera ${name} (${CAMERA_NAMES.indexOf(name) + 1})`, () => this.useCamera(name));
      this.cameraButtons_.set(name, choose);
      cameras.append(choose);
    }
    const panel = make("div", "panel");
    for (const option of this.view.available) {
      const box = make("input");
      box.type = "checkbox";
      box.checked = this.view.options[option];
      box.addEventListener("change", () => this.setOption(option, box.checked));
      this.optionBoxes_.set(option, box);
      panel.append(make("label", "", box, OPTION_TEXTS[option]));
    }
    panel.append(this.arrowScale());
    const menu = make("details", "options", make("summary", "", "show"), panel);
    return make("nav", "toolbar", cameras, menu, this.sections(), this.measureButton_);
  }

  /** Along which axis of the container the drawing is cut open, and where. */
  private sections(): HTMLElement {
    const slider = make("input");
    slider.type = "range";
    [slider.min, slider.max, slider.step, slider.value] = ["0", "1", "0.005", "0.5"];
    slider.title = "From one side of the container to the other";
    slider.addEventListener("input", () => this.view.setSection(this.view.section.axis, Number(slider.value)));
    const axes = make("div", "cameras");
    for (const axis of SECTION_AXES) {
      const choose = button(axis, axis === "off" ? "Nothing is cut away" : `Cut open along ${axis} of the container`, () => this.setSection(axis));
      choose.classList.toggle("on", axis === this.view.section.axis);
      this.sectionBoxes_.set(axis, choose);
      axes.append(choose);
    }
    return make("details", "options section", make("summary", "", "section"), make("div", "panel", axes, slider));
  }

  setSection(axis: SectionAxis, part?: number): void {
    this.view.setSection(axis, part);
    for (const [key, element] of this.sectionBoxes_) element.classList.toggle("on", key === axis);
  }

  private nextSection(): void {
    this.setSection(SECTION_AXES[(SECTION_AXES.indexOf(this.view.section.axis) + 1) % SECTION_AXES.length]!);
  }

  setMeasuring(on: boolean): void {
    this.isMeasuring_ = on;
    this.measureButton_.classList.toggle("on", on);
    this.stage_.classList.toggle("measuring", on);
    if (!on) this.view.measure.clear();
    this.view.invalidate();
  }

  private arrowScale(): HTMLElement {
    const slider = make("input");
    slider.type = "range";
    [slider.min, slider.max, slider.step, slider.value] = ["-1", "1", "0.05", "0"];
    const text = make("span", "", "arrows 8 mm/N");
    slider.addEventListener("input", () => {
      this.view.arrowScale = 0.008 * 10 ** Number(slider.value);
      text.textContent = `arrows ${(1000 * this.view.arrowScale).toPrecision(2)} mm/N`;
      this.view.invalidate();
    });
    return make("label", "scale", text, slider);
  }

  setOption(option: ViewOption, on: boolean): void {
    this.view.setOption(option, on);
    const box = this.optionBoxes_.get(option);
    if (box) box.checked = on;
  }

  useCamera(name: CameraName): void {
    this.view.useCamera(name);
    for (const [key, element] of this.cameraButtons_) element.classList.toggle("on", key === name);
  }

  setTheme(theme: Theme): void {
    this.theme_ = theme;
    document.documentElement.dataset.theme = theme;
    this.view.setTheme(theme);
    this.legend_.setPalette();
    this.plots.setTheme(theme);
    this.drawEnd();
  }

  private showHelp(): void {
    this.help_.dispatchEvent(new Event("snug:show"));
  }

  private listen(): void {
    let down: [number, number] = [0, 0];
    this.view.canvas.addEventListener("pointerdown", (e) => (down = [e.clientX, e.clientY]));
    this.view.canvas.addEventListener("click", (e) => {
      if (Math.hypot(e.clientX - down[0], e.clientY - down[1]) > 4) return;
      this.click(e.offsetX, e.offsetY, e.shiftKey);
    });
    window.addEventListener("keydown", (e) => this.key(e), { signal: this.gone_.signal });
  }

  private click(x: number, y: number, isTrace: boolean): void {
    if (this.isMeasuring_) {
      const point = this.view.surfacePoint(x, y);
      if (point) this.view.measure.add(point);
      this.view.invalidate();
      return;
    }
    const picked = this.view.pick(x, y);
    if (picked && isTrace) {
      this.view.setTracePoint(this.view.cornerPoint(picked.body, picked.corner));
      this.setOption("trace", true);
      return;
    }
    const name = picked ? this.replay.bodies[picked.body]!.name : "";
    this.itemEvents.select(name === this.itemEvents.selected ? "" : name);
  }

  private key(e: KeyboardEvent): void {
    const isField = e.target instanceof HTMLSelectElement || (e.target instanceof HTMLInputElement && e.target.type !== "range");
    if (isField || e.ctrlKey || e.metaKey || e.altKey) return;
    const { player } = this;
    const actions: Record<string, () => void> = {
      " ": () => player.toggle(),
      ArrowLeft: () => (e.shiftKey ? player.setTime(player.time - 1) : player.step(-1)),
      ArrowRight: () => (e.shiftKey ? player.setTime(player.time + 1) : player.step(1)),
      "[": () => this.timeline_.jump(-1),
      "]": () => this.timeline_.jump(1),
      "-": () => player.faster(-1),
      "+": () => player.faster(1),
      "=": () => player.faster(1),
      Home: () => player.setTime(this.replay.start),
      End: () => player.setTime(this.replay.end),
      d: () => this.setTheme(this.theme_ === "light" ? "dark" : "light"),
      "?": () => this.showHelp(),
      i: () => this.about_.toggle(),
      c: () => this.about_.toggle("container"),
      g: () => this.timeline_.askTime(),
      f: () => this.setOption("frames", !this.view.options.frames),
      r: () => this.setOption("robot", !this.view.options.robot),
      x: () => this.setOption("xray", !this.view.options.xray),
      w: () => this.plots.setWide(!this.plots.isWide),
      m: () => this.setMeasuring(!this.isMeasuring_),
      s: () => this.nextSection(),
      Escape: () => {
        this.setMeasuring(false);
        this.help_.hidden = true;
        this.about_.hide();
      },
    };
    this.cameraNames.forEach((name, k) => (actions[String(k + 1)] = () => this.useCamera(name)));
    const action = actions[e.key];
    if (!action) return;
    e.preventDefault();
    action();
  }
}
