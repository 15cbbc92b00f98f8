// Colours of the drawing, light and dark. Hues follow Okabe and Ito: told apart with any kind of colour vision; what
// matters also differs in lightness, shape or lettering.

import { Color } from "three";

export type Theme = "light" | "dark";

export interface Palette {
  background: string;
  ground: string;
  grid: string;
  fixed: string;
  belt: string;
  metal: string;
  edge: string;
  wall: string;
  wallOpacity: number;
  boxEdge: string;
  boxInk: string;
  tool: string;
  link: string;
  cup: string;
  lip: string;
  ghost: string;
  trace: string;
  second: string;
  select: string;
  sticking: string;
  sliding: string;
  open: string;
  unknown: string;
  cupWrench: string;
  flangeWrench: string;
  skyLight: string;
  groundLight: string;
  ambient: number;
  sun: number;
}

const light: Palette = {
  background: "#eef1f4",
  ground: "#e3e7eb",
  grid: "#c3cad1",
  fixed: "#cfd5da",
  belt: "#8d969e",
  metal: "#a9b1b8",
  edge: "#7b858e",
  wall: "#5d86ad",
  wallOpacity: 0.2,
  boxEdge: "#3d3428",
  boxInk: "#2a241c",
  tool: "#59636c",
  link: "#93a1ad",
  cup: "#39434c",
  lip: "#1f262c",
  ghost: "#4b5d70",
  trace: "#a8327c",
  second: "#111111",
  select: "#0b62c4",
  sticking: "#0072b2",
  sliding: "#d55e00",
  open: "#8a9299",
  unknown: "#555c63",
  cupWrench: "#7a3fb0",
  flangeWrench: "#00755a",
  skyLight: "#ffffff",
  groundLight: "#aeb6bd",
  ambient: 2.0,
  sun: 1.9,
};

const dark: Palette = {
  background: "#14181c",
  ground: "#1a1f24",
  grid: "#303840",
  fixed: "#3a434b",
  belt: "#272d33",
  metal: "#5b656e",
  edge: "#6c7882",
  wall: "#7fb2dd",
  wallOpacity: 0.15,
  boxEdge: "#1d1812",
  boxInk: "#1d1812",
  tool: "#8f9aa4",
  link: "#75828d",
  cup: "#5d6a75",
  lip: "#2f383f",
  ghost: "#b9c7d6",
  trace: "#f07cc4",
  second: "#ffffff",
  select: "#6db9ff",
  sticking: "#3aa9ee",
  sliding: "#ff8a3c",
  open: "#8a949d",
  unknown: "#b7bec5",
  cupWrench: "#c79bff",
  flangeWrench: "#35d0a5",
  skyLight: "#dfe9f2",
  groundLight: "#39434d",
  ambient: 1.75,
  sun: 1.6,
};

export const PALETTES: Record<Theme, Palette> = { light, dark };

/** Muted, so that contacts, arrows and marks stand out against the boxes; lightness differs from type to type. */
const BOX_COLOURS = ["#dfb46c", "#8cc4ea", "#b184b8", "#57a58b", "#e8d98a", "#c9785c", "#9aa3ab", "#6f87c4"];

/** Colour of each box type, in the order in which types appear. */
export class BoxColours {
  private readonly byType_ = new Map<string, string>();

  of(type: string): string {
    let colour = this.byType_.get(type);
    if (!colour) {
      colour = BOX_COLOURS[this.byType_.size % BOX_COLOURS.length]!;
      this.byType_.set(type, colour);
    }
    return colour;
  }

  /** Assigns the colours in the order of names, so that B1 has the same one in every recording. */
  learn(types: string[]): void {
    for (const type of [...new Set(types)].sort()) this.of(type);
  }

  get types(): [string, string][] {
    return [...this.byType_];
  }
}

export const colour = (text: string): Color => new Color(text);

/** Series colours of plots: x, y, z, then others. */
export const SERIES: Record<Theme, string[]> = {
  light: ["#d55e00", "#009e73", "#0072b2", "#b0468a", "#806000", "#5b6770", "#7a3fb0"],
  dark: ["#ff8a3c", "#2ccf9f", "#56b4e9", "#f07cc4", "#f0e442", "#aab6c0", "#c79bff"],
};
