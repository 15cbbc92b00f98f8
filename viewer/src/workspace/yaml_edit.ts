// YAML edits: numbers of a scenario's text, read and replaced where they stand, so that comments and layout stay.

interface Span {
  begin: number;
  end: number;
}

/** The text with comments blanked: as long as before, so that places in it are places in the text. */
function withoutComments(text: string): string {
  return text.replace(/(^|\s)#.*$/gm, (comment) => comment.replace(/[^\n]/g, " "));
}

/** Metres of a number in mm, without zeros that say nothing. */
export function metres(mm: number): string {
  return String(Number((mm / 1000).toFixed(6)));
}

function sizeSpans(text: string): Span[] {
  return [...withoutComments(text).matchAll(/\binner_size:\s*\[([^\]]*)\]/g)].map((found) => {
    const end = found.index + found[0].length - 1;
    return { begin: end - found[1]!.length, end };
  });
}

/** Is there one inner_size for each of `count` containers? Else a form cannot know which one it would change. */
export function canEditSize(text: string, count: number): boolean {
  return count > 0 && sizeSpans(text).length === count;
}

/** With the inner size of container `index` replaced, mm. */
export function setInnerSize(text: string, index: number, size: number[]): string {
  const span = sizeSpans(text)[index];
  return span ? text.slice(0, span.begin) + size.map(metres).join(", ") + text.slice(span.end) : text;
}

/** The block of a top-level key: its line and those that are indented more, or what is in its braces. */
function cupSpan(text: string): Span | null {
  const found = /^cup:.*(?:\n(?:[ \t]+.*|[ \t]*(?=\n)))*/m.exec(withoutComments(text));
  return found && { begin: found.index, end: found.index + found[0].length };
}

export function canEditCup(text: string): boolean {
  return setCupRadius(text, 1) !== text;
}

/** With cup.lip_radius replaced or put there, mm; the text itself where the cup is written in a way that is not known. */
export function setCupRadius(text: string, radius: number): string {
  const span = cupSpan(text);
  if (!span) return text;
  const plain = withoutComments(text).slice(span.begin, span.end);
  const value = /\blip_radius:\s*([-+.\deE]+)/.exec(plain);
  if (value) {
    const end = span.begin + value.index + value[0].length;
    return text.slice(0, end - value[1]!.length) + metres(radius) + text.slice(end);
  }
  const insert = (at: number, words: string): string => text.slice(0, span.begin + at) + words + text.slice(span.begin + at);
  const braces = /^cup:\s*\{\s*/.exec(plain);
  if (braces) return insert(braces[0].length, `lip_radius: ${metres(radius)}${plain[braces[0].length] === "}" ? "" : ", "}`);
  const block = /^cup:[ \t]*\n([ \t]+)(?=\S)/.exec(plain);
  if (block) return insert(block[0].length, `lip_radius: ${metres(radius)}\n${block[1]}`);
  return text;
}
