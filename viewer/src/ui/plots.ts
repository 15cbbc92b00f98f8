// Plots: a column of time series under one time cursor; a second recording is drawn dashed.

import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Replay } from "../replay/replay";
import { SERIES, type Theme } from "../scene/palette";
import { make } from "./dom";
import type { Player } from "./player";
import { figuresOf, thin, type Figure } from "./series";

const HEIGHT = 118;
const POINTS = 1600;

export class Plots {
  readonly element = make("aside", "plots");
  private plots_: uPlot[] = [];
  private box_ = "";
  private theme_: Theme;
  private width_ = 0;
  /** What is shown of the time, s; null is all of it. */
  private range_: [number, number] | null = null;
  private zoomTimer_ = 0;

  constructor(
    private readonly replay: Replay,
    private readonly second: Replay | null,
    private readonly player: Player,
    theme: Theme,
  ) {
    this.theme_ = theme;
    player.onSlowChange(() => this.moveCursor());
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
    this.element.replaceChildren();
    if (this.width_ === 0) return;
    for (const figure of figuresOf(this.box_)) this.add(figure);
    if (this.plots_.length === 0) this.element.append(make("p", "empty", "This recording has no tool and no cup to plot."));
    this.moveCursor();
  }

  private add(figure: Figure): void {
    const tables: uPlot.AlignedData[] = [];
    const series: uPlot.Series[] = [{ label: "t [s]" }];
    for (const [r, replay] of [this.replay, this.second].entries()) {
      const values = replay ? figure.values(replay) : null;
      if (!replay || !values) continue;
      values.forEach((value, k) => {
        const [begin, stop] = this.range_ ? [replay.frameAt(this.range_[0]), replay.frameAt(this.range_[1]) + 1] : [0, replay.frames];
        const [times, numbers] = thin(replay, value, POINTS, begin, stop);
        if (numbers.every((v) => v === null)) return;
        tables.push([times, numbers]);
        series.push({
          label: r === 0 ? figure.names[k]! : `${figure.names[k]} (2nd)`,
          stroke: SERIES[this.theme_][k]!,
          width: r === 0 ? 1.25 : 1,
          ...(r === 0 ? {} : { dash: [5, 4] }),
          // Tables of different times are joined with gaps of undefined: those are bridged, nulls are not.
          spanGaps: false,
          points: { show: false },
        });
      });
    }
    if (tables.length === 0) return;
    const host = make("figure", "plot", this.caption(figure, series));
    this.element.append(host);
    const plot = new uPlot(this.options(series), uPlot.join(tables), host);
    plot.over.addEventListener("click", () => {
      const left = plot.cursor.left ?? -1;
      if (left >= 0) this.player.setTime(plot.posToVal(left, "x"));
    });
    this.plots_.push(plot);
  }

  private caption(figure: Figure, series: uPlot.Series[]): HTMLElement {
    const caption = make("figcaption", "", make("b", "", figure.title), ` [${figure.unit}] `);
    if (series.length < 3) return caption;
    const firsts = series.slice(1).filter((s) => !s.dash);
    for (const s of firsts.length > 1 ? firsts : []) {
      const key = make("span", "key", String(s.label));
      key.style.color = String(s.stroke);
      caption.append(key);
    }
    if (firsts.length < series.length - 1) caption.append(make("span", "dashed", "dashed: 2nd"));
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

  private options(series: uPlot.Series[]): uPlot.Options {
    const style = getComputedStyle(document.documentElement);
    const ink = style.getPropertyValue("--ink-soft").trim();
    const line = style.getPropertyValue("--line").trim();
    const axis = { stroke: ink, font: "10px system-ui, sans-serif", grid: { stroke: line, width: 1 }, ticks: { stroke: line, width: 1, size: 4 } };
    return {
      width: this.width_,
      height: HEIGHT,
      series,
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
      scales: { x: this.range_ ? { time: false, range: this.range_ } : { time: false } },
      axes: [
        { ...axis, size: 22, gap: 2, values: (_: uPlot, ticks: number[]) => ticks.map((t) => `${t} s`) },
        { ...axis, size: 44, gap: 3, space: 22 },
      ],
      hooks: {
        draw: [(plot: uPlot) => this.drawCursor(plot)],
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

  private moveCursor(): void {
    for (const plot of this.plots_) this.drawCursor(plot);
  }
}
