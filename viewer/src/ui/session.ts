// SessionPanel: the first thing on the page of a packing session: filling, boxes an hour, lost, why it ended, what would help.

import type { Replay } from "../replay/replay";
import { nameOf, summarizeSession, type SessionSummary } from "../replay/session";
import { make } from "./dom";

function figure(label: string, value: string, note = "", isBad = false): HTMLElement {
  return make("div", isBad ? "bad" : "", make("dt", "", label), make("dd", "", make("b", "", value), ...(note ? [make("small", "", note)] : [])));
}

function refusals(summary: SessionSummary): HTMLElement | null {
  if (summary.refused.length === 0) return null;
  const list = make("ul", "refused");
  for (const { id, article, reason } of summary.refused) list.append(make("li", "", make("b", "", nameOf(article, id)), ` ${reason}`));
  return make("details", "", make("summary", "", `${summary.refused.length} without a place`), list);
}

/** Null for what is no packing session. */
export function sessionPanel(replay: Replay): HTMLElement | null {
  const summary = summarizeSession(replay.header);
  if (!summary) return null;
  const { packed, came, ordered, lost } = summary;
  const keys = make("dl", "keys",
    figure("filling degree", summary.filling === null ? "–" : `${summary.filling.toFixed(1)} %`),
    figure("boxes an hour", summary.perHour === null ? "–" : summary.perHour.toFixed(0)),
    figure("packed", String(packed), `of ${came} that came, ${ordered} ordered`),
    figure("lost", String(lost), "", lost > 0),
  );
  const panel = make("section", "session", keys, make("p", "ended", make("small", "", "ended: "), summary.ended));
  const refused = refusals(summary);
  if (refused) panel.append(refused);
  if (summary.help.length) panel.append(make("div", "help", make("small", "", "what would help"), make("ul", "", ...summary.help.map((text) => make("li", "", text)))));
  return panel;
}
