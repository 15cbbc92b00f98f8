// Page: the frame that all pages made here have: one HTML file without scripts and without anything to load.
#include "snug/report/page.hpp"

#include "snug/report/escape.hpp"

namespace snug::report {
namespace {

// Names and values of the inks as in viewer/src/ui/style.css: a test compares them.
constexpr const char* kStyle = R"(
:root { --paper: #ffffff; --paper-soft: #f5f7f9; --ink: #1c242b; --ink-soft: #56626d; --line: #dce2e7; --accent: #0b62c4; --bad: #b3261e;
  --mean: #c05621; --box-light: 50%; --box-span: 42%; color-scheme: light; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #1a1f24; --paper-soft: #14181c; --ink: #e6ebef; --ink-soft: #9aa7b2; --line: #2d353d; --accent: #6db9ff; --bad: #ff8a80;
    --mean: #f6ad55; --box-light: 24%; --box-span: 38%; color-scheme: dark; }
}
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1rem 1rem 3rem; max-width: 74rem; background: var(--paper); color: var(--ink);
  font: 15px/1.5 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; overflow-wrap: break-word; }
h1 { font-size: 1.5rem; line-height: 1.25; } h2 { font-size: 1.15rem; margin: 2.2rem 0 .5rem; } h3 { font-size: 1rem; margin: 1.4rem 0 .3rem; }
p { max-width: 62rem; } a { color: var(--accent); } small, .na, dt, figcaption { color: var(--ink-soft); }
section { border-top: 2px solid var(--line); margin-top: 2rem; }
.scroll { overflow-x: auto; margin: .6rem 0; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .2rem .7rem; text-align: right; border-bottom: 1px solid var(--line); vertical-align: baseline; }
th { font-weight: 600; color: var(--ink-soft); } thead th { border-bottom-width: 2px; } tfoot td { font-weight: 600; border-bottom: 0; }
.text { text-align: left; } td.text { overflow-wrap: break-word; }
code, pre { font: 12px/1.45 ui-monospace, "DejaVu Sans Mono", monospace; } code { overflow-wrap: anywhere; }
pre { white-space: pre-wrap; overflow-wrap: anywhere; background: var(--paper-soft); border: 1px solid var(--line); border-radius: 5px; padding: 8px 10px; }
.keys { display: flex; flex-wrap: wrap; gap: .6rem 2.2rem; margin: .8rem 0; }
.keys dt { font-size: 13px; } .keys dd { margin: 0; } .keys b { font-size: 1.25rem; color: var(--accent); display: block; line-height: 1.3; }
.beside { display: flex; flex-wrap: wrap; gap: 14px 20px; } .card { width: 230px; }
figure { margin: .6rem 0; max-width: 100%; } figcaption { font-size: 13px; font-weight: 600; }
figure > img { width: 100%; background: #fff; } svg { max-width: 100%; height: auto; }
svg text { font-size: 11px; fill: var(--ink-soft); } .rule { stroke: var(--line); } .dot { fill: var(--accent); fill-opacity: .65; }
.interval { stroke: var(--accent); stroke-width: 2; } .mean { stroke: var(--mean); stroke-width: 3; }
.floor { fill: var(--paper-soft); stroke: var(--ink-soft); } .thing { fill: var(--line); stroke: var(--ink-soft); }
.robot { fill: var(--accent); fill-opacity: .25; stroke: var(--accent); } .reach { fill: none; stroke: var(--accent); stroke-dasharray: 4 4; }
.unreached { fill: var(--bad); } .bar { stroke: var(--ink-soft); stroke-width: 2; }
.packed { stroke: var(--ink); stroke-width: 1; fill: hsl(32 55% calc(var(--box-light) + var(--height) * var(--box-span))); }
@media (max-width: 500px) { body { padding: .6rem .6rem 2rem; font-size: 14px; } th, td { padding: .2rem .45rem; } .card { width: 100%; } .card svg { width: 100%; } }
@media print {
  :root { --paper: #fff; --paper-soft: #f5f7f9; --ink: #000; --ink-soft: #444; --line: #bbb; --accent: #0b62c4; --mean: #c05621; --box-light: 50%; --box-span: 42%; color-scheme: light; }
  body { max-width: none; padding: 0; font-size: 10pt; print-color-adjust: exact; } .scroll { overflow: visible; } table { font-size: 8pt; }
  figure, .card, tr { break-inside: avoid; } h2, h3 { break-after: avoid; } details::details-content { content-visibility: visible; block-size: auto; }
}
)";

}  // namespace

std::string make_page(std::string_view title, const Markup& content) {
  const std::string name = escape(title);
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><meta name=\"generator\" "
         "content=\"snug\">"
         "<link rel=\"icon\" href=\"data:,\"><title>" +
         name + "</title><style>" + kStyle + "</style></head><body>\n<h1>" + name + "</h1>\n" + content.html() +
         "</body></html>\n";
}

}  // namespace snug::report
