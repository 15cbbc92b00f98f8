// Plots: a column of time series under one time cursor, with what they are at that time; a second recording is drawn dashed.

import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Replay } from "../replay/replay";
import { SERIES, type Theme } from "../scene/palette";
import { digits, make } from "./dom";
import type { Player } from "./player";
import { figuresOf, thin, type Figure, type Group } from "./series";

const HEIGHT = 106;
const POINTS = 1600;
const TITLES: Record<Group, string> = {
  box: "Box", tool: "Tool", cup: "Cup", flange: "Flange", robot: "Robot", contacts: "Contacts and solver",
};

/** One curve: where its number stands in the caption, and how to read it at a time. */
interface Reading {
  text: HTMLElement;
  value: (frame: number) => number;
  replay: Replay;
}

export class Plots {
  readonly element = make("aside", "plots");
  private plots_: uPlot[] = [];
  private readings_: Reading[] = [];
  private readonly when_ = make("p", "when");
  private box_ = "";
  private theme_: Theme;
  private width_ = 0;
  /** What is shown of the time, s; null is all of it. */
  private range_: [number, number] | null = null;
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
    player.onSlowChange(() => this.moveCursor());
    this.element.addEventListener("mouseleave", () => {
      this.hover_ = null;
      this.read();
    });
  }

  /** Makes the plots, and again whenever their column changes its width. */
  start(): void {
    new ResizeObserver(() => this.fit()).observe(this.element);
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
    this.zoom(this.range_);
  }

  private fit(): void {
    const width = this.element.clientWidth - 14;
    if (width < 60 || Math.abs(width - this.width_) < 2) return;
    this.width_ = width;
    if (this.plots_.length === 0) this.build();
    else for (const plot of this.plots_) plot.setSize({ width, height: HEIGHT });
  }

  private build(): void {
    for (const plot of this.plots_) plot.destroy();
    this.plots_ = [];
    this.readings_ = [];
    this.element.replaceChildren(this.when_);
    if (this.width_ === 0) return;
    const figures = figuresOf(this.box_).filter((figure) => figure.values(this.replay) !== null || (this.second && figure.values(this.second) !== null));
    for (const group of new Set(figures.map((figure) => figure.group))) this.addGroup(group, figures.filter((figure) => figure.group === group));
    if (figures.length === 0) this.element.append(make("p", "empty", "This recording has no tool, no cup and no contacts to plot."));
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
    const tables: uPlot.AlignedData[] = [];
    const series: uPlot.Series[] = [{ label: "t [s]" }];
    const readings: Reading[] = [];
    for (const [r, replay] of [this.replay, this.second].entries()) {
      const values = replay ? figure.values(replay) : null;
      if (!replay || !values) continue;
      values.forEach((value, k) => {
        const [begin, stop] = this.range_ ? [replay.frameAt(this.range_[0]), replay.frameAt(this.range_[1]) + 1] : [0, replay.frames];
        const [times, numbers] = thin(replay, value, POINTS, begin, stop);
        if (numbers.every((v) => v === null)) return;
        tables.push([times, numbers]);
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
    if (tables.length === 0) return;
    const host = make("figure", "plot", this.caption(figure, series.slice(1), readings));
    parent.append(host);
    const plot = new uPlot(this.options(series, figure.unit), uPlot.join(tables), host);
    plot.over.addEventListener("click", () => {
      const left = plot.cursor.left ?? -1;
      if (left >= 0) this.player.setTime(plot.posToVal(left, "x"));
    });
    this.plots_.push(plot);
    this.readings_.push(...readings);
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

  /** Shows a stretch of time in all plots, with all frames that fit; null shows the whole run. */
  zoom(range: [number, number] | null): void {
    window.clearTimeout(this.zoomTimer_);
    this.zoomTimer_ = window.setTimeout(() => {
      this.range_ = range;
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
      height: HEIGHT,
      series,
      padding: [5, 8, 0, 0],
      legend: { show: false },
      cursor: {
        sync: { key: "snug" },
        drag: { x: true, y: false, setScale: false },
        bind: {
          dblclick: () => () => {
            this.zoom(null);
            return null;
          },
        },
      },
      scales: {
        x: this.range_ ? { time: false, range: this.range_ } : { time: false },
        // What does not change at all is drawn in the middle of a stretch that can be read.
        y: { range: (_, low, high) => (Number.isFinite(low) && high - low < 1e-12 ? [low - 1, high + 1] : uPlot.rangeNum(low ?? 0, high ?? 1, 0.06, false)) },
      },
      axes: [
        { ...axis, size: 22, gap: 2, values: (_: uPlot, ticks: number[]) => ticks.map((t) => `${t} s`) },
        { ...axis, size: unit.length > 3 ? 58 : 46, gap: 3, space: 17, values: (_: uPlot, ticks: number[]) => ticks.map((v, i) => (i === ticks.length - 1 && unit !== "1" ? `${tick(v)} ${unit}` : tick(v))) },
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
    this.when_.textContent = this.hover_ === null ? `numbers at ${time.toFixed(3)} s` : `numbers under the mouse, at ${time.toFixed(3)} s`;
    for (const { text, value, replay } of this.readings_) {
      const shown = digits(value(replay.frameAt(time)));
      if (text.textContent !== shown) text.textContent = shown;
    }
  }

  private moveCursor(): void {
    for (const plot of this.plots_) this.drawCursor(plot);
    this.read();
  }
}

const tick = (value: number): string => String(Number(value.toPrecision(6)));
