// DOM: makes elements in one line.

export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  className = "",
  ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  if (className) element.className = className;
  element.append(...children);
  return element;
}

export function button(text: string, title: string, onClick: () => void, className = ""): HTMLButtonElement {
  const element = make("button", className, text);
  element.type = "button";
  element.title = title;
  element.addEventListener("click", () => {
    onClick();
    element.blur(); // so that the space bar goes on to mean play
  });
  return element;
}

export const seconds = (t: number, digits = 2): string => `${t.toFixed(digits)} s`;

/** A number as engineers read it, four digits. */
export function digits(value: number): string {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-4) return value.toExponential(2);
  return value.toFixed(Math.min(4, Math.max(0, 3 - Math.floor(Math.log10(size)))));
}
