// Plots: a column of time series under one time cursor, with what they are at that time; a second recording is drawn dashed. What is
// shown of the time is the whole run, a window that follows the cursor, or a stretch that was dragged.

import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Replay } from "../replay/replay";
import { SERIES, type Theme } from "../scene/palette";
import { button, digits, make } from "./dom";
import type { Player } from "./player";
import { figuresOf, thin, type Figure, type Group } from "./series";

const HEIGHT = 106;
const HEIGHT_WIDE = 150;
const POINTS = 1600;
/** Room for the longest label of a value, such as -0.025 Nm, px; the same in all plots, so that their times are in line. */
const LABELS = 62;
/** Lengths of the window that follows the cursor, s; 0 is the whole run. */
const WINDOWS = [0, 120, 60, 20, 5, 1];
/** Of longer runs a column of this width shows a window at first, s. */
const LONG = 60;
const FIRST_WINDOW = 20;
/** Where the cursor stands in the window, of its length. */
const CURSOR_AT = 0.6;
/** Of uPlot.join: where a curve has no values it has none between them either, at times of other curves. */
const NULLS_EXPAND = 2;
/** Curves are read for so many windows, and again when the cursor leaves them. */
const AHEAD = 3;
const TITLES: Record<Group, string> = {
  box: "Box", tool: "Tool", cup: "Cup", flange: "Flange", limits: "Limits", robot: "Robot", contacts: "Contacts and solver",
};

/** One curve: where its number stands in the caption, and how to read it at a time. */
interface Reading {
  text: HTMLElement;
  value: (frame: number) => number;
  replay: Replay;
}

type Range = [number, number];

/** One drawing, and how to read its curves again for a stretch of time. */
interface Drawn {
  plot: uPlot;
  host: HTMLElement;
  read: (range: Range | null) => uPlot.AlignedData;
  loaded: Range | null;
}

export class Plots {
  readonly element = make("aside", "plots");
  /** Asks for a wide view of the plots, or for the usual one. */
  onWide: (isWide: boolean) => void = () => {};
  private plots_: Drawn[] = [];
  private readings_: Reading[] = [];
  private readonly when_ = make("span");
  private readonly window_ = make("select", "window");
  private readonly back_: HTMLButtonElement;
  private readonly wide_: HTMLButtonElement;
  private readonly bar_: HTMLElement;
  private box_ = "";
  private theme_: Theme;
  private width_ = 0;
  /** The stretch that was dragged, s; null: none, then the window follows the cursor. */
  private range_: Range | null = null;
  /** Stretches shown before it, for the way back. */
  private before_: (Range | null)[] = [];
  private isWide_ = false;
  private zoomTimer_ = 0;
  /** Time under the mouse, s; null when it is elsewhere. */
  private hover_: number | null = null;
  private readonly closed_ = new Set<Group>(["contacts"]);

  constructor(
    private readonly replay: Replay,
    private readonly second: Replay | null,
    private readonly player: Player,
    theme: Theme,
  ) {
    this.theme_ = theme;
    this.back_ = button("↩", "Back to what was shown before (double click on a plot: the whole run)", () => this.goBack(), "back");
    this.wide_ = button("wide", "Wide plots, or the usual column (w)", () => this.setWide(!this.isWide_));
    this.bar_ = make("div", "when", this.when_, this.window_, this.back_, this.wide_);
    this.window_.title = "How much of the time the plots show around the cursor";
    this.window_.addEventListener("change", () => this.zoom(null));
    player.onSlowChange(() => this.moveCursor());
    this.element.addEventListener("mouseleave", () => {
      this.hover_ = null;
      this.read();
    });
    this.element.addEventListener("scroll", () => this.follow());
    this.offerWindows();
  }

  /** The windows that are shorter than the run. */
  private offerWindows(): void {
    const length = this.replay.end - this.replay.start;
    const chosen = this.window_.options.length ? Number(this.window_.value) : length > LONG ? FIRST_WINDOW : 0;
    this.window_.replaceChildren(...WINDOWS.filter((w) => w === 0 || w < length).map((w) => new Option(w === 0 ? "whole run" : `${w} s`, String(w))));
    this.window_.value = String(chosen);
    if (this.window_.value === "") this.window_.value = "0";
  }

  /** Makes the plots, and again whenever their column changes its width. */
  start(): void {
    new ResizeObserver(() => this.fit()).observe(this.element);
  }

  get isWide(): boolean {
    return this.isWide_;
  }

  setWide(isWide: boolean): void {
    this.isWide_ = isWide;
    this.wide_.classList.toggle("on", isWide);
    this.onWide(isWide);
    this.width_ = 0; // another height too
    this.fit();
  }

  /** What is shown of the time, s; null is all of it. */
  get shown(): Range | null {
    if (this.range_) return this.range_;
    const length = Number(this.window_.value);
    const { start, end } = this.replay;
    if (!(length > 0) || length >= end - start) return null;
    const begin = Math.min(Math.max(this.player.time - CURSOR_AT * length, start), end - length);
    return [begin, begin + length];
  }

  setTheme(theme: Theme): void {
    this.theme_ = theme;
    this.build();
  }

  setBox(box: string): void {
    this.box_ = box;
    this.build();
    if (box) this.element.scrollTop = 0;
  }

  /** Draws all curves again: a live run grows. */
  refresh(): void {
    this.offerWindows();
    this.rebuild();
  }

  private fit(): void {
    const width = this.element.clientWidth - 14;
    if (width < 60 || Math.abs(width - this.width_) < 2) return;
    this.width_ = width;
    if (this.plots_.length === 0) this.build();
    else for (const { plot } of this.plots_) plot.setSize({ width, height: this.height });
  }

  private get height(): number {
    return this.isWide_ ? HEIGHT_WIDE : HEIGHT;
  }

  private build(): void {
    for (const { plot } of this.plots_) plot.destroy();
    this.plots_ = [];
    this.readings_ = [];
    this.back_.hidden = this.before_.length === 0;
    this.element.replaceChildren(this.bar_);
    if (this.width_ === 0) return;
    const figures = figuresOf(this.box_).filter((figure) => figure.values(this.replay) !== null || (this.second && figure.values(this.second) !== null));
    const groups = new Set(figures.map((figure) => figure.group));
    if (groups.size === 1) this.closed_.clear(); // there is nothing else to see
    for (const group of groups) this.addGroup(group, figures.filter((figure) => figure.group === group));
    if (figures.length === 0) this.element.append(make("p", "empty", "Nothing to plot yet: select a box to plot where it is."));
    this.moveCursor();
  }

  private addGroup(group: Group, figures: Figure[]): void {
    const host = make("details", "group", make("summary", "", group === "box" ? this.box_ : TITLES[group]));
    host.open = !this.closed_.has(group);
    host.addEventListener("toggle", () => {
      const isKnown = host.open !== this.closed_.has(group);
      if (isKnown) return; // the event of the opening above
      if (host.open) this.closed_.delete(group);
      else this.closed_.add(group);
      this.refresh();
    });
    this.element.append(host);
    if (!host.open) return;
    for (const figure of figures) this.add(figure, host);
    if (host.childElementCount === 1) host.append(make("p", "empty", group === "box" ? "It never was in the cell." : "Nothing was recorded of it."));
  }

  private add(figure: Figure, parent: HTMLElement): void {
    const series: uPlot.Series[] = [{ label: "t [s]" }];
    const readings: Reading[] = [];
    for (const [r, replay] of [this.replay, this.second].entries()) {
      const values = replay ? figure.values(replay) : null;
      if (!replay || !values) continue;
      values.forEach((value, k) => {
        if (!hasNumbers(replay, value)) return;
        readings.push({ text: make("output"), value, replay });
        series.push({
          label: figure.names[k]!,
          stroke: SERIES[this.theme_][k % SERIES[this.theme_].length]!,
          width: r === 0 ? 1.25 : 1,
          ...(r === 0 ? {} : { dash: [5, 4] }),
          // Tables of different times are joined with gaps of undefined: those are bridged, nulls are not.
          spanGaps: false,
          points: { show: false },
        });
      });
    }
    if (readings.length === 0) return;
    const read = (range: Range | null): uPlot.AlignedData =>
      uPlot.join(
        readings.map(({ value, replay }): uPlot.AlignedData => {
          const [begin, stop] = range ? [replay.frameAt(range[0]), replay.frameAt(range[1]) + 1] : [0, replay.frames];
          return thin(replay, value, POINTS, begin, stop);
        }),
        readings.map(() => [NULLS_EXPAND, NULLS_EXPAND]),
      );
    const host = make("figure", "plot", this.caption(figure, series.slice(1), readings));
    parent.append(host);
    const loaded = this.around(this.shown);
    const plot = new uPlot(this.options(series, figure.unit), read(loaded), host);
    plot.over.addEventListener("click", () => {
      const left = plot.cursor.left ?? -1;
      if (left >= 0) this.player.setTime(plot.posToVal(left, "x"));
    });
    this.plots_.push({ plot, host, read, loaded });
    this.readings_.push(...readings);
  }

  /** The stretch whose curves are read to show a window: wider, so that the cursor can move. */
  private around(shown: Range | null): Range | null {
    if (!shown || this.range_) return shown;
    const more = (AHEAD - 1) * 0.5 * (shown[1] - shown[0]);
    return [shown[0] - more, shown[1] + more];
  }

  /** Moves the window of the plots that are in view to where the cursor is. */
  private follow(): void {
    const shown = this.shown;
    if (!shown) return;
    const [top, bottom] = [this.element.scrollTop - this.height, this.element.scrollTop + this.element.clientHeight];
    for (const drawn of this.plots_) {
      const { plot, host } = drawn;
      if (host.offsetTop < top || host.offsetTop > bottom) continue;
      const { min, max } = plot.scales.x!;
      if (min === shown[0] && max === shown[1]) continue;
      plot.batch(() => {
        if (!drawn.loaded || shown[0] < drawn.loaded[0] || shown[1] > drawn.loaded[1]) {
          drawn.loaded = this.around(shown);
          plot.setData(drawn.read(drawn.loaded), false);
        }
        plot.setScale("x", { min: shown[0], max: shown[1] });
      });
    }
  }

  /** Title and unit, and for each curve its name in its colour with its number at the time. */
  private caption(figure: Figure, series: uPlot.Series[], readings: Reading[]): HTMLElement {
    const caption = make("figcaption", "", make("div", "", make("b", "", figure.title), ` [${figure.unit}]`));
    for (const isSecond of [false, true]) {
      const line = make("div", isSecond ? "keys dashed" : "keys");
      series.forEach((s, k) => {
        if ((readings[k]!.replay === this.second) !== isSecond) return;
        const name = make("span", "key", figure.names.length > 1 ? `${String(s.label)} ` : "", readings[k]!.text);
        name.style.color = String(s.stroke);
        line.append(name);
      });
      if (line.childElementCount) caption.append(line);
    }
    return caption;
  }

  /** Shows a stretch of time in all plots, with all frames that fit; null shows the window again. */
  zoom(range: Range | null): void {
    if (range) this.before_.push(this.range_);
    else this.before_ = [];
    this.range_ = range;
    this.rebuild();
  }

  private goBack(): void {
    this.range_ = this.before_.pop() ?? null;
    this.rebuild();
  }

  private rebuild(): void {
    window.clearTimeout(this.zoomTimer_);
    this.zoomTimer_ = window.setTimeout(() => {
      const scroll = this.element.scrollTop;
      this.build();
      this.element.scrollTop = scroll;
    });
  }

  private options(series: uPlot.Series[], unit: string): uPlot.Options {
    const style = getComputedStyle(document.documentElement);
    const ink = style.getPropertyValue("--ink-soft").trim();
    const line = style.getPropertyValue("--line").trim();
    const axis = { stroke: ink, font: "10px system-ui, sans-serif", grid: { stroke: line, width: 1 }, ticks: { stroke: line, width: 1, size: 4 } };
    return {
      width: this.width_,
      height: this.height,
      series,
      padding: [5, 18, 0, 0], // room for half a label of the time
      legend: { show: false },
      cursor: {
        sync: { key: "snug" },
        drag: { x: true, y: false, setScale: false },
        bind: {
          dblclick: () => () => {
            this.window_.value = "0";
            this.zoom(null);
            return null;
          },
        },
      },
      scales: {
        x: { time: false, range: (_, low, high) => this.shown ?? [low, high] },
        // What does not change at all is drawn in the middle of a stretch that can be read.
        y: { range: (_, low, high) => (Number.isFinite(low) && high - low < 1e-12 ? [low - 1, high + 1] : uPlot.rangeNum(low ?? 0, high ?? 1, 0.06, false)) },
      },
      axes: [
        { ...axis, size: 22, gap: 2, values: (_: uPlot, ticks: number[]) => ticks.map((t) => `${t} s`) },
        { ...axis, size: LABELS, gap: 3, space: 17, values: (_: uPlot, ticks: number[]) => ticks.map((v, i) => (i === ticks.length - 1 && unit !== "1" ? `${tick(v)} ${unit}` : tick(v))) },
      ],
      hooks: {
        draw: [(plot: uPlot) => this.drawCursor(plot)],
        setCursor: [
          (plot: uPlot) => {
            const left = plot.cursor.left ?? -1;
            if (!plot.over.matches(":hover")) return; // the others only follow
            this.hover_ = left >= 0 ? plot.posToVal(left, "x") : null;
            this.read();
          },
        ],
        setSelect: [
          (plot: uPlot) => {
            const { left, width } = plot.select;
            if (!plot.over.matches(":hover")) return; // the others only follow
            if (width > 3) this.zoom([plot.posToVal(left, "x"), plot.posToVal(left + width, "x")]);
          },
        ],
      },
    };
  }

  private drawCursor(plot: uPlot): void {
    let line = plot.over.querySelector<HTMLElement>(".now");
    if (!line) {
      line = make("i", "now");
      plot.over.append(line);
    }
    const x = plot.valToPos(this.player.time, "x");
    line.style.display = x >= 0 && x <= plot.over.clientWidth ? "" : "none";
    line.style.transform = `translateX(${x.toFixed(1)}px)`;
  }

  /** Writes the numbers of all curves at the time under the mouse, else at the time cursor. */
  private read(): void {
    const time = this.hover_ ?? this.player.time;
    this.when_.textContent = this.hover_ === null ? `values at ${time.toFixed(3)} s` : `under the mouse, ${time.toFixed(3)} s`;
    for (const { text, value, replay } of this.readings_) {
      const shown = digits(value(replay.frameAt(time)));
      if (text.textContent !== shown) text.textContent = shown;
    }
  }

  private moveCursor(): void {
    this.follow();
    for (const { plot } of this.plots_) this.drawCursor(plot);
    this.read();
  }
}

/** Whether a curve has a number anywhere. */
function hasNumbers(replay: Replay, value: (frame: number) => number): boolean {
  for (let frame = 0; frame < replay.frames; ++frame) if (Number.isFinite(value(frame))) return true;
  return false;
}

const tick = (value: number): string => String(Number(value.toPrecision(6)));
