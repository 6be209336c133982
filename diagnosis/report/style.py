"""The report's style sheet: system fonts, light and dark scheme, print, and pictures that shrink to a phone.

The colours are told apart by people with any common colour blindness (after Okabe and Ito), and directions also by
the dashes of their lines.
"""

from __future__ import annotations

CSS = """
:root { --page:#fff; --ink:#1a1d21; --soft:#5b636e; --rule:#d9dde2; --card:#f5f6f8; --grid:#e8ebee;
  --before:#d55e00; --after:#0072b2; --forward:#00855f; --backward:#b0509a; --cause:#0072b2;
  --first:#0072b2; --second:#b58900; --third:#c8402a; --fourth:#6a3d9a;
  --new:#d55e00; --good:#00734f; color-scheme: light dark; }
@media (prefers-color-scheme: dark) { :root { --page:#15181c; --ink:#e8eaed; --soft:#a2abb6; --rule:#3a4048;
  --card:#1e2227; --grid:#2a2f36; --before:#f0883e; --after:#58a6e8; --forward:#3fc89b; --backward:#d98bc5;
  --cause:#58a6e8; --first:#58a6e8; --second:#e0b93a; --third:#f0785e; --fourth:#b59be0;
  --new:#f0883e; --good:#3fc89b; } }
*, *::before { box-sizing: border-box; }
a { color: inherit; }
html { -webkit-text-size-adjust: 100%; }
body { margin: 0 auto; max-width: 74rem; padding: 1.5rem 1.25rem 4rem; background: var(--page); color: var(--ink);
  font: 16px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", "DejaVu Sans", sans-serif; }
h1 { font-size: 1.05rem; font-weight: 600; color: var(--soft); margin: 0 0 .25rem; overflow-wrap: anywhere; }
.verdict { font-size: clamp(1.35rem, 4.2vw, 2rem); line-height: 1.25; font-weight: 650; margin: 0 0 1.25rem;
  max-width: 46rem; text-wrap: balance; }
h2 { font-size: 1.3rem; line-height: 1.3; margin: 3rem 0 .5rem; padding-top: 1rem; border-top: 1px solid var(--rule); }
h3 { font-size: 1.12rem; line-height: 1.3; margin: 2rem 0 .4rem; }
p { margin: .4rem 0 .8rem; max-width: 46rem; }
code, .name { font-family: ui-monospace, "SF Mono", Menlo, Consolas, "DejaVu Sans Mono", monospace; font-size: .92em; }
.soft { color: var(--soft); }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(9.4rem, 1fr)); gap: .75rem;
  margin: 0 0 1rem; padding: 0; }
.figures div { background: var(--card); border-radius: .5rem; padding: .7rem .9rem; }
.figures dt { color: var(--soft); font-size: .84rem; line-height: 1.3; }
.figures dd { margin: .15rem 0 0; font-size: 1.35rem; font-weight: 600; font-variant-numeric: tabular-nums; }
.figures dd small { font-size: .6em; font-weight: 400; color: var(--soft); }
.plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 27rem), 1fr)); gap: 1.25rem 1.75rem; }
@media (min-width: 64rem) { .beside { display: grid; grid-template-columns: 1fr 1fr; gap: 0 1.75rem; }
  .beside .plots { grid-template-columns: 1fr; } }
figure { margin: .25rem 0; break-inside: avoid; min-width: 0; }
figcaption { font-size: .88rem; line-height: 1.4; color: var(--soft); margin-bottom: .3rem; }
figcaption b { color: var(--ink); font-weight: 600; }
svg { display: block; width: 100%; height: auto; }
svg text { font-size: 12.5px; fill: var(--soft); font-variant-numeric: tabular-nums; }
svg .label { fill: var(--ink); }
svg path { fill: none; }
.grid { stroke: var(--grid); } .frame { stroke: var(--soft); }
.points, .marks { stroke-linecap: round; stroke-width: 2.6; }
.points { stroke-opacity: .5; } .few { stroke-width: 4; stroke-opacity: .75; }
.crosses { stroke-width: .9; stroke-opacity: .75; } .crosses.few { stroke-width: 1.2; stroke-opacity: .9; }
.sample.crosses { stroke-width: 1.6; stroke-opacity: 1; } .marks { stroke-width: 7; }
.sample.points { stroke-width: 7; stroke-opacity: 1; }
.legend { display: flex; flex-wrap: wrap; gap: .1rem 1rem; font-size: .82rem; color: var(--soft);
  margin: 0 0 .35rem 1rem; }
.legend svg { display: inline-block; width: 26px; height: 12px; margin-right: .35rem; vertical-align: -1px; }
.line { stroke-width: 1.6; stroke-linejoin: round; }
.c-before { stroke: var(--before); } .c-after { stroke: var(--after); } .c-cause { stroke: var(--cause); }
.c-forward { stroke: var(--forward); } .c-backward { stroke: var(--backward); } .c-model { stroke: var(--ink); }
.c-first { stroke: var(--first); } .c-second { stroke: var(--second); } .c-third { stroke: var(--third); }
.c-fourth { stroke: var(--fourth); }
.line.deep { stroke-width: 2.4; stroke: color-mix(in srgb, var(--ink) 55%, var(--cause)); }
.line.c-forward.deep { stroke: color-mix(in srgb, var(--ink) 45%, var(--forward)); }
.line.c-backward.deep { stroke: color-mix(in srgb, var(--ink) 45%, var(--backward)); stroke-dasharray: 7 3; }
.line.c-first.deep { stroke: color-mix(in srgb, var(--ink) 45%, var(--first)); }
.line.c-second.deep { stroke: color-mix(in srgb, var(--ink) 45%, var(--second)); stroke-dasharray: 7 3; }
.line.c-third.deep { stroke: color-mix(in srgb, var(--ink) 45%, var(--third)); stroke-dasharray: 2 3; }
.line.c-fourth.deep { stroke: color-mix(in srgb, var(--ink) 45%, var(--fourth)); stroke-dasharray: 9 2 2 2; }
.dashed { stroke-dasharray: 5 4; } svg .beyond { stroke: none; fill: var(--soft); }
.scroll { overflow-x: auto; }
footer { margin-top: 3rem; color: var(--soft); font-size: .84rem; overflow-wrap: anywhere; }
table { border-collapse: collapse; margin: .5rem 0 1rem; font-size: .94rem; }
th, td { text-align: left; vertical-align: top; padding: .35rem 1.1rem .35rem 0; border-bottom: 1px solid var(--rule); }
th { font-weight: 600; color: var(--soft); font-size: .84rem; vertical-align: bottom; }
td.number, th.number { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; }
ol.chain { list-style: none; display: grid; gap: .55rem 1.1rem; padding: 0; margin: 1rem 0;
  grid-template-columns: repeat(auto-fit, minmax(7.6rem, 1fr)); }
.chain li { position: relative; border: 1px solid var(--rule); border-radius: .5rem; padding: .5rem .6rem .55rem;
  background: var(--card); min-height: 5.2rem; break-inside: avoid; }
.chain li:not(:last-child):not(.last)::after { content: "\\2192"; position: absolute; right: -1.02rem; top: 1.9rem;
  color: var(--soft); }
.chain .apart { border-style: dashed; background: none; }
.chain h4 { margin: 0 0 .25rem; font-size: .8rem; color: var(--soft); font-weight: 600; }
.chain span { display: block; font-size: .84rem; line-height: 1.35; overflow-wrap: break-word; }
.chain .new { margin: .25rem -.35rem 0; padding: .15rem .35rem; border-radius: .3rem; color: var(--page);
  background: var(--new); font-weight: 600; }
.told { background: var(--card); border-left: 3px solid var(--new); border-radius: 0 .4rem .4rem 0;
  padding: .5rem .9rem; max-width: 46rem; margin: .6rem 0; }
@media (max-width: 40rem) {
  body { padding: 1rem .9rem 3rem; } h2 { margin-top: 2.2rem; }
  svg text { font-size: 15px; } th, td { padding-right: .7rem; }
  ol.chain { grid-template-columns: 1fr; gap: 1.3rem; } .chain li { min-height: 0; }
  .chain li:not(:last-child):not(.last)::after { content: "\\2193"; right: auto; left: 1rem; top: auto;
    bottom: -1.42rem; }
  .stacked thead { display: none; } .stacked, .stacked tbody, .stacked tr { display: block; }
  .stacked tr { border-bottom: 1px solid var(--rule); padding: .4rem 0; }
  .stacked td, .stacked td.number { display: block; border: 0; padding: .1rem 0 .1rem 8.2rem; text-align: left;
    white-space: normal; }
  .stacked td:empty { display: none; }
  .stacked td::before { content: attr(data-head); color: var(--soft); display: inline-block;
    width: 8.2rem; margin-left: -8.2rem; padding-right: .6rem; vertical-align: top; }
}
@media print {
  :root { --page:#fff; --ink:#000; --soft:#444; --rule:#bbb; --card:#fff; --grid:#e4e4e4; --before:#d55e00;
    --after:#0072b2; --forward:#00855f; --backward:#b0509a; --cause:#0072b2; --first:#0072b2; --second:#b58900;
    --third:#c8402a; --fourth:#6a3d9a; --new:#b84f00; }
  @page { margin: 16mm 14mm; }
  body { max-width: none; padding: 0; font-size: 10.5pt; }
  h2, h3, h2 + p, h3 + p { break-after: avoid; } table, .told, .figures, .cause-head, .chain { break-inside: avoid; }
  .figures div, .told { border: 1px solid var(--rule); } .plots { grid-template-columns: 1fr 1fr; gap: 4mm 6mm; }
  .beside { display: block; } .beside .plots { grid-template-columns: 95mm; }
  .chain .new { print-color-adjust: exact; -webkit-print-color-adjust: exact; } .scroll { overflow: visible; }
}
"""
