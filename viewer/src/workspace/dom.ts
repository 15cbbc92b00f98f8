// DOM: labelled fields, buttons and tables of the page of `snug ui`.

import { make } from "../ui/dom";

export { make };

export function action(text: string, onClick: () => void | Promise<void>, className = ""): HTMLButtonElement {
  const element = make("button", className, text);
  element.type = "button";
  element.addEventListener("click", () => void onClick());
  return element;
}

/** A label with its field in it; by a click on the words one gets into the field. */
export function field<T extends HTMLElement>(label: string, control: T, className = ""): HTMLLabelElement {
  return make("label", `field ${className}`.trim(), make("span", "", label), control);
}

export function textInput(value = ""): HTMLInputElement {
  const input = make("input");
  input.type = "text";
  input.value = value;
  input.spellcheck = false;
  input.autocomplete = "off";
  return input;
}

export function numberInput(value: number | "", min: number, max: number, step: number | "any"): HTMLInputElement {
  const input = make("input");
  input.type = "number";
  input.min = String(min);
  input.max = String(max);
  input.step = String(step);
  input.value = String(value);
  return input;
}

/** Choices in the place of what was there; what was chosen stays where it can. The same ones are left alone: a list may be open. */
export function setChoices(select: HTMLSelectElement, choices: [value: string, text: string][], prefer = ""): void {
  const before = prefer || select.value;
  const areSame = select.options.length === choices.length && choices.every(([value, text], k) => select.options[k]!.value === value && select.options[k]!.text === text.replace(/\s+/g, " ").trim());
  if (areSame) {
    if (choices.some(([value]) => value === before)) select.value = before;
    return;
  }
  select.replaceChildren(...choices.map(([value, text]) => {
    const option = make("option", "", text);
    option.value = value;
    return option;
  }));
  if (choices.some(([value]) => value === before)) select.value = before;
}

export function table(head: (Node | string)[], rows: (Node | string)[][], className = ""): HTMLTableElement {
  const element = make("table", className);
  const cells = (words: (Node | string)[], tag: "th" | "td"): HTMLTableRowElement => make("tr", "", ...words.map((word) => make(tag, "", word)));
  element.append(make("thead", "", cells(head, "th")), make("tbody", "", ...rows.map((row) => cells(row, "td"))));
  for (const th of element.tHead!.querySelectorAll("th")) th.scope = "col";
  return element;
}

export function link(text: string, address: string, download = ""): HTMLAnchorElement {
  const element = make("a", "", text);
  element.href = address;
  if (download) {
    element.download = download;
  } else {
    element.target = "_blank";
    element.rel = "noopener";
  }
  return element;
}

/** Letters, digits, '.', '_' and '-' of a name, without its ending. */
export function plainName(name: string, otherwise: string): string {
  const stem = name.replace(/\.[A-Za-z0-9]*$/, "").normalize("NFKD").replace(/\p{M}+/gu, "").replace(/[^A-Za-z0-9._-]+/g, "-").replace(/^[^A-Za-z0-9]+/, "").slice(0, 60);
  return stem || otherwise;
}

/** Can be scrolled by keys. */
export function scrollable<T extends HTMLElement>(element: T): T {
  element.tabIndex = 0;
  return element;
}

/** Calls after nothing has asked for it for that long, ms. */
export function later(wait: number, call: () => void): () => void {
  let timer = 0;
  return () => {
    window.clearTimeout(timer);
    timer = window.setTimeout(call, wait);
  };
}
