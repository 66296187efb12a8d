// The page's style sheet: one column, rules as in a printed table, colours for light and dark that the figures follow.
#pragma once
#include <string_view>

namespace sysid {

inline constexpr std::string_view page_style = R"css(:root {
  color-scheme: light dark;
  --paper: #ffffff; --ink: #1f2933; --muted: #5c6772; --rule: #d5dbe1; --faint: #f4f6f8; --accent: #1b5e9b; --shade: #1f293344;
  --good: #22694b; --doubtful: #875a06; --bad: #a82e26;
  --fig-ink: #1f2933; --fig-muted: #66717d; --fig-rule: #e3e7ec; --fig-paper: none; --fig-model: #1b5e9b; --fig-band: #a9c8e4;
  --fig-noise-band: #dce8f3; --fig-data: #3d4852; --fig-contrast: #b4541a;
  --fig-chain-1: #1b5f9c; --fig-chain-2: #c8741f; --fig-chain-3: #44aa99; --fig-chain-4: #882255;
  --fig-chain-5: #56b4e9; --fig-chain-6: #6b4226; --fig-chain-7: #332288; --fig-chain-8: #101418;
}
@media screen and (prefers-color-scheme: dark) {
  :root {
    --paper: #14181d; --ink: #dfe4ea; --muted: #9ca8b4; --rule: #343d47; --faint: #1c2229; --accent: #7db8e8; --shade: #9ca8b466;
    --good: #5cbf92; --doubtful: #dcab4f; --bad: #e8857c;
    --fig-ink: #dfe4ea; --fig-muted: #95a1ad; --fig-rule: #2a323b; --fig-model: #7db8e8; --fig-band: #33597c;
    --fig-noise-band: #20354a; --fig-data: #c3cbd3; --fig-contrast: #ee9a63;
    --fig-chain-1: #7db8e8; --fig-chain-2: #e0862f; --fig-chain-3: #7fe0c4; --fig-chain-4: #d05a92;
    --fig-chain-5: #cfe6ff; --fig-chain-6: #8f6238; --fig-chain-7: #7a6ae8; --fig-chain-8: #f2e6b0;
  }
}
* { box-sizing: border-box; }
html { font: 16px/1.55 system-ui, -apple-system, "Segoe UI", "Helvetica Neue", Arial, "Liberation Sans", sans-serif; }
body { margin: 0 auto; max-width: 60rem; padding: 2.2rem 1.5rem 3rem; background: var(--paper); color: var(--ink); }
header { border-bottom: 2px solid var(--ink); padding-bottom: 1rem; margin-bottom: 0.8rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0; font-weight: 650; letter-spacing: -0.01em; overflow-wrap: anywhere; }
h2 { font-size: 1.3rem; line-height: 1.3; margin: 2.6rem 0 0.7rem; font-weight: 650; }
h3 { font-size: 1.08rem; margin: 1.7rem 0 0.4rem; font-weight: 650; }
h4 { font-size: 1rem; margin: 1.2rem 0 0.3rem; font-weight: 600; }
p { margin: 0.5rem 0; }
a { color: var(--accent); }
a:focus-visible, summary:focus-visible, [tabindex]:focus-visible { outline: 3px solid var(--accent); outline-offset: 2px; }
.skip { position: absolute; left: -999rem; }
.skip:focus { position: static; display: inline-block; padding: 0.3rem 0.6rem; }
nav { font-size: 0.92rem; }
nav ul { display: flex; flex-wrap: wrap; gap: 0.15rem 1.2rem; margin: 0; padding: 0; list-style: none; }
nav li.good, nav li.doubtful, nav li.bad, nav li.plain { flex-basis: 100%; }
.task { margin: 0 0 0.2rem; color: var(--accent); font-weight: 600; }
.what { margin: 0.4rem 0 0; color: var(--muted); }
nav .what { margin: 0 0.4rem; }
.good b, dt.good { color: var(--good); } .doubtful b { color: var(--doubtful); } .bad b, dt.bad { color: var(--bad); }
.whole { border-top: 2px solid var(--ink); margin-top: 3rem; }
.verdict { border-left: 5px solid var(--good); background: var(--faint); padding: 0.9rem 1.2rem; margin: 1.5rem 0; }
.verdict > h2, .verdict > h3 { margin: 0; font-size: 0.9rem; color: var(--muted); }
.verdict .headline { margin: 0 0 0.3rem; font-size: 1.25rem; font-weight: 650; color: var(--good); }
.verdict.doubtful { border-color: var(--doubtful); } .verdict.doubtful .headline { color: var(--doubtful); }
.verdict.bad { border-color: var(--bad); } .verdict.bad .headline { color: var(--bad); }
.verdict ul { margin: 0.6rem 0 0.2rem; padding-left: 1.1rem; }
.verdict li { margin: 0.35rem 0; overflow-wrap: anywhere; }
.verdict li.error b { color: var(--bad); } .verdict li.warning b { color: var(--doubtful); } .verdict li.note b { color: var(--muted); }
.verdict .help { color: var(--muted); } .code { color: var(--muted); font-size: 0.85em; }
.equations { font-size: 1.2rem; margin: 0.6rem 0 1.2rem; padding-left: 1.2rem; overflow-x: auto; }
.equations p { margin: 0.2rem 0; }
math { font-family: "STIX Two Math", "Cambria Math", "Latin Modern Math", "DejaVu Math TeX Gyre", math; }
math[display="block"] { width: fit-content; margin: 0.55rem 0; }
.scroll { overflow-x: auto; margin: 0.9rem 0; }
/* What goes on beyond an edge casts a shade there: two sheets of paper move with the content and cover it at the ends. */
.scroll, .equations, figure {
  background: linear-gradient(to right, var(--paper) 30%, transparent) left / 2rem 100% no-repeat local,
    linear-gradient(to left, var(--paper) 30%, transparent) right / 2rem 100% no-repeat local,
    linear-gradient(to right, var(--shade), transparent) left / 0.7rem 100% no-repeat scroll,
    linear-gradient(to left, var(--shade), transparent) right / 0.7rem 100% no-repeat scroll;
}
table { border-collapse: collapse; border-top: 1.5px solid var(--ink); border-bottom: 1.5px solid var(--ink); font-size: 0.9rem; }
caption { text-align: left; font-weight: 600; padding-bottom: 0.3rem; }
/* It stays on the screen while what it heads is scrolled. */
caption span { display: inline-block; position: sticky; left: 0; max-width: calc(100vw - 2.2rem); }
th, td { padding: 0.28rem 0.9rem 0.28rem 0; text-align: left; vertical-align: baseline; }
th:last-child, td:last-child { padding-right: 0.2rem; }
thead th, thead td { font-weight: 600; color: var(--muted); border-bottom: 1px solid var(--rule); vertical-align: bottom; }
tbody th { font-weight: 600; white-space: nowrap; }
.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
thead .n { white-space: normal; }
.unit { color: var(--muted); font-weight: 400; font-size: 0.92em; white-space: nowrap; }
td code { font-size: 0.88em; white-space: nowrap; }
.range { width: 130px; height: 18px; vertical-align: middle; }
.outside { color: var(--doubtful); font-size: 0.92em; }
.range .wide { fill: var(--fig-band); } .range .narrow { fill: var(--accent); } .range .mean { fill: var(--ink); }
code, pre, .digest { font-family: ui-monospace, "SF Mono", Menlo, Consolas, "Liberation Mono", monospace; font-size: 0.85em; }
.digest { color: var(--muted); overflow-wrap: anywhere; }
pre { background: var(--faint); padding: 0.9rem 1.1rem; overflow-x: auto; line-height: 1.45; }
pre code { font-size: inherit; }
.command code { user-select: all; }
details { margin: 0.8rem 0; }
summary { cursor: pointer; color: var(--accent); width: fit-content; }
dl { margin: 0.8rem 0; display: grid; grid-template-columns: fit-content(14rem) 1fr; gap: 0.3rem 1rem; font-size: 0.95rem; }
dt { font-weight: 600; } dd { margin: 0; }
figure { margin: 1.2rem 0 2rem; }
figure > svg { width: 100%; height: auto; display: block; }
figcaption, .note { color: var(--muted); font-size: 0.88rem; max-width: 46rem; }
figcaption { margin-top: 0.4rem; } figcaption b { color: var(--ink); }
footer { margin-top: 3rem; padding-top: 0.7rem; border-top: 1px solid var(--rule); color: var(--muted); font-size: 0.85rem; }
@media (max-width: 40rem) {
  body { padding: 1.2rem 1rem 2rem; }
  h1 { font-size: 1.5rem; }
  dl { display: block; } dd { margin: 0 0 0.5rem; }
  .equations { padding-left: 0; }
  figure { overflow-x: auto; margin-left: -1rem; margin-right: -1rem; } figcaption { padding: 0 1rem; }
  tbody th { white-space: normal; }
  /* What a score says stands below it. */
  .said, .said thead, .said tbody { display: block; }
  .said tr { display: grid; grid-template-columns: 1fr auto; padding-top: 0.25rem; }
  .said td:last-child { grid-column: 1 / -1; }
  .said thead :last-child:not(tr) { display: none; }
}
@media screen and (min-width: 75rem) {
  /* A wide table takes the margin to the right. */
  .scroll { width: fit-content; max-width: calc(50vw + 27rem); }
}
@media print {
  @page { margin: 17mm 15mm; }
  :root { color-scheme: light; }
  html { font-size: 10pt; }
  body { max-width: none; padding: 0; }
  nav .link, .skip { display: none; }
  a { color: inherit; text-decoration: none; }
  /* Of one column (480: a test holds it to plot::column_width) two stand on a page. */
  figure { margin: 0.6rem 0 1.2rem; } figure > svg[viewBox^="0 0 480 "] { width: 120mm; }
  figure, .scroll, tr, .headline, dt, dd { break-inside: avoid; }
  h2, h3, h4, caption, thead { break-after: avoid; }
  .whole + .whole { break-before: page; }
  .command { break-before: avoid; }
  .whole { border: 0; margin-top: 0; }
  .scroll, pre, .equations { overflow: visible; } .scroll, .equations, figure { background: none; }
  table { font-size: 8.5pt; } th, td { padding-right: 0.7rem; }
  pre { white-space: pre-wrap; overflow-wrap: anywhere; }
  .verdict, pre { background: none; border: 1px solid var(--rule); } .verdict { border-left: 5px solid var(--good); }
  .range { width: 80px; }
  details::details-content { display: block; content-visibility: visible; block-size: auto; }
  summary { list-style: none; color: inherit; font-weight: 600; }
}
)css";

}  // namespace sysid
